// A place in a JSON file that knows its path, so that an error can name it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "study/study_file.h"

namespace psf::report {

// A place refers to its document, which must outlive it. Where a value is not as expected, every
// function throws Error{bad_input} "FILE: /rows/3: expected ...; REMEDY".
class JsonPlace {
 public:
  JsonPlace(const study::Json& document, std::string file, std::string remedy)
      : value_(&document), file_(std::move(file)), remedy_(std::move(remedy)) {}

  [[nodiscard]] JsonPlace member(const std::string& name) const;  // must exist
  // Empty where the member is missing or null.
  [[nodiscard]] std::optional<JsonPlace> optional_member(const std::string& name) const;
  [[nodiscard]] JsonPlace element(std::size_t index) const;

  [[nodiscard]] std::size_t size() const;  // length of an array
  [[nodiscard]] std::string text() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] std::optional<double> number_or_null() const;
  void expect_object() const;
  void expect_texts() const;  // an object of nothing but texts
  // The value is an object of nothing but numbers and nulls. The two functions below check the
  // member `name` where it exists.
  void expect_numbers() const;
  void optional_numbers(const std::string& name) const;
  void optional_number(const std::string& name) const;

  [[noreturn]] void fail(const std::string& expected) const;
  [[nodiscard]] const study::Json& value() const { return *value_; }

 private:
  [[nodiscard]] JsonPlace at(const study::Json& value, const std::string& name) const;

  const study::Json* value_;
  std::string file_, remedy_, path_;
};

}  // namespace psf::report
