// A place in a JSON document that knows its path, with typed getters whose errors name file and
// place.
#pragma once

#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"

namespace psf::render {

// The range of numbers that a getter accepts; `text` ends the sentence "expected a number ...".
struct Range {
  double min = -FLT_MAX, max = FLT_MAX;
  const char* text = "that fits a 32-bit float";
};
constexpr Range kAnyNumber{};
constexpr Range kUnitRange{0, 1, "in [0, 1]"};
constexpr Range kNonNegative{0, FLT_MAX, ">= 0"};
constexpr Range kPositive{FLT_MIN, FLT_MAX, "> 0"};

// All getters throw Error{bad_input}: "cornell.json:31: /materials/2/roughness: expected a number
// in [0, 1], got "shiny"". A cursor points into the document and must not outlive it.
class JsonCursor {
 public:
  JsonCursor(const nlohmann::json& root, std::string file)
      : value_(&root), file_(std::move(file)) {}

  // Checks that this is an object with no keys except `known` and "comment". The error suggests the
  // nearest known key.
  void check_keys(std::span<const std::string_view> known) const;
  void check_keys(std::initializer_list<std::string_view> known) const {
    check_keys(std::span(known.begin(), known.size()));
  }
  [[nodiscard]] JsonCursor at(std::string_view key) const;  // member of an object; must exist
  [[nodiscard]] std::optional<JsonCursor> find(std::string_view key) const;
  [[nodiscard]] std::vector<JsonCursor> items() const;  // the items of an array
  // Items of the array under `key`, none where the key is missing.
  [[nodiscard]] std::vector<JsonCursor> items(std::string_view key) const;

  [[nodiscard]] std::size_t size() const;                  // length of an array
  [[nodiscard]] JsonCursor item(std::size_t index) const;  // index < size()
  [[nodiscard]] std::vector<std::string> keys() const;     // the keys of an object
  [[nodiscard]] bool is_array() const;
  [[nodiscard]] bool is_object() const;
  [[nodiscard]] bool is_text() const;
  [[nodiscard]] float number(const Range& range = kAnyNumber) const;
  [[nodiscard]] std::uint32_t integer(std::uint32_t min, std::uint32_t max) const;
  // A whole number up to `max`, which glTF allows to be written as 36.0 and 3.6e1 too.
  [[nodiscard]] std::uint64_t whole(std::uint64_t max = std::uint64_t{1} << 53) const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  // The index in `known` of the text, which must be one of them.
  [[nodiscard]] std::size_t choice(std::span<const std::string_view> known) const;
  [[nodiscard]] Vec2 vec2(const Range& range = kAnyNumber) const;
  [[nodiscard]] Imath::V2d vec2d(const Range& range = kAnyNumber) const;
  [[nodiscard]] Vec3 vec3(const Range& range = kAnyNumber) const;
  [[nodiscard]] Imath::V3d vec3d(const Range& range = kAnyNumber) const;
  [[nodiscard]] double real(const Range& range = kAnyNumber) const;
  [[nodiscard]] Vec3 direction() const;             // normalised; throws for the zero vector
  [[nodiscard]] Rgb rgb(const Range& range) const;  // [r, g, b] or one number for grey
  [[nodiscard]] std::vector<double> numbers(std::size_t count,
                                            const Range& range = kAnyNumber) const;

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::string path() const { return path_.empty() ? "/" : path_; }  // JSON pointer
  // "FILE:LINE: PATH", for errors: the file is read once more to find the line.
  [[nodiscard]] std::string where() const;
  [[noreturn]] void fail(const std::string& problem) const;
  [[noreturn]] void expected(const std::string& what) const;  // "expected what, got the value"

 private:
  JsonCursor(const nlohmann::json& value, std::string file, std::string path)
      : value_(&value), file_(std::move(file)), path_(std::move(path)) {}
  void read_numbers(std::span<double> out, const Range& range) const;

  const nlohmann::json* value_;
  std::string file_, path_;
};

// "; did you mean "glass"?" for the nearest of `known`, or nothing where none is near.
[[nodiscard]] std::string suggestion(std::string_view word,
                                     std::span<const std::string_view> known);

}  // namespace psf::render
