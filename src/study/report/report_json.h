// A place in a JSON file that knows its path, so that an error can name it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "study/study_file.h"

namespace psf::study {

// Refers to the document, which must outlive it. Everything throws Error{bad_input} "FILE: /rows/3:
// expected ...; REMEDY".
class JsonPlace {
 public:
  JsonPlace(const Json& document, std::string file, std::string remedy)
      : value_(&document), file_(std::move(file)), remedy_(std::move(remedy)) {}

  [[nodiscard]] JsonPlace member(const std::string& name) const;  // must exist
  // Empty where it is missing or null.
  [[nodiscard]] std::optional<JsonPlace> optional_member(const std::string& name) const;
  [[nodiscard]] JsonPlace element(std::size_t index) const;

  [[nodiscard]] std::size_t size() const;  // of an array
  [[nodiscard]] std::string text() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] std::optional<double> number_or_null() const;
  void expect_object() const;
  void expect_texts() const;  // an object of nothing but texts
  // An object of nothing but numbers and nulls; under `name`, where it is there.
  void expect_numbers() const;
  void optional_numbers(const std::string& name) const;
  void optional_number(const std::string& name) const;

  [[noreturn]] void fail(const std::string& expected) const;
  [[nodiscard]] const Json& value() const { return *value_; }

 private:
  [[nodiscard]] JsonPlace at(const Json& value, const std::string& name) const;

  const Json* value_;
  std::string file_, remedy_, path_;
};

}  // namespace psf::study
