#include "render/scene/json/cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.h"
#include "render/scene/json/file.h"

namespace psf::render {
namespace {

using Json = nlohmann::json;

// A value as a message shows it.
std::string quoted(const Json& value) {
  constexpr std::size_t kMost = 60, kMostItems = 16;
  if (value.is_object()) return "an object";
  const bool is_short =
      !value.is_array() ||
      (value.size() <= kMostItems && std::none_of(value.begin(), value.end(), [](const Json& item) {
         return item.is_structured();
       }));
  if (!is_short) return "an array";
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  return text;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

std::string suggestion(std::string_view word, std::span<const std::string_view> known) {
  std::size_t best = word.size() / 3 + 2;  // farther is no typing error
  std::string text;
  for (const std::string_view candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best) {
      best = distance;
      text = fmt::format("; did you mean \"{}\"?", candidate);
    }
  }
  return text;
}

void JsonCursor::fail(const std::string& problem) const {
  throw Error(ErrorCode::bad_input, where() + ": " + problem);
}

std::string JsonCursor::where() const {
  const std::size_t line = line_of(file_, path_);
  return line == 0 ? file_ + ": " + path() : fmt::format("{}:{}: {}", file_, line, path());
}

void JsonCursor::expected(const std::string& what) const {
  fail(fmt::format("expected {}, got {}", what, quoted(*value_)));
}

void JsonCursor::check_keys(std::span<const std::string_view> known) const {
  if (!value_->is_object()) expected("an object");
  for (const auto& [key, value] : value_->items()) {
    if (key == "comment" || std::find(known.begin(), known.end(), key) != known.end()) continue;
    fail(fmt::format("unknown key \"{}\"{}", key, suggestion(key, known)));
  }
}

std::optional<JsonCursor> JsonCursor::find(std::string_view key) const {
  if (!value_->is_object()) expected("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return JsonCursor(*found, file_, fmt::format("{}/{}", path_, key));
}

JsonCursor JsonCursor::at(std::string_view key) const {
  auto found = find(key);
  if (!found) fail(fmt::format("the key \"{}\" is missing", key));
  return *found;
}

bool JsonCursor::is_array() const {
  return value_->is_array();
}
bool JsonCursor::is_object() const {
  return value_->is_object();
}
bool JsonCursor::is_text() const {
  return value_->is_string();
}

std::size_t JsonCursor::size() const {
  if (!value_->is_array()) expected("an array");
  return value_->size();
}

JsonCursor JsonCursor::item(std::size_t index) const {
  return JsonCursor((*value_)[index], file_, fmt::format("{}/{}", path_, index));
}

std::vector<std::string> JsonCursor::keys() const {
  if (!value_->is_object()) expected("an object");
  std::vector<std::string> result;
  for (const auto& [key, value] : value_->items()) result.push_back(key);
  return result;
}

std::vector<JsonCursor> JsonCursor::items() const {
  std::vector<JsonCursor> result;
  result.reserve(size());
  for (std::size_t i = 0; i < value_->size(); ++i) result.push_back(item(i));
  return result;
}

std::vector<JsonCursor> JsonCursor::items(std::string_view key) const {
  const auto found = find(key);
  return found ? found->items() : std::vector<JsonCursor>{};
}

float JsonCursor::number(const Range& range) const {
  return static_cast<float>(real(range));
}

double JsonCursor::real(const Range& range) const {
  const double value = value_->is_number() ? value_->get<double>() : 2 * range.max;
  if (!(value >= range.min && value <= range.max)) expected(fmt::format("a number {}", range.text));
  return value;
}

std::uint32_t JsonCursor::integer(std::uint32_t min, std::uint32_t max) const {
  const bool fits = value_->is_number_unsigned() && value_->get<std::uint64_t>() >= min &&
                    value_->get<std::uint64_t>() <= max;
  if (!fits) expected(fmt::format("a whole number from {} to {}", min, max));
  return value_->get<std::uint32_t>();
}

std::uint64_t JsonCursor::whole(std::uint64_t max) const {
  const double value = value_->is_number() ? value_->get<double>() : -1;
  const bool fits = value >= 0 && value <= static_cast<double>(max) && value == std::floor(value);
  if (!fits) expected(fmt::format("a whole number from 0 to {}", max));
  return static_cast<std::uint64_t>(value);
}

bool JsonCursor::boolean() const {
  if (!value_->is_boolean()) expected("true or false");
  return value_->get<bool>();
}

std::string JsonCursor::text() const {
  if (!value_->is_string()) expected("a text in quotes");
  return value_->get<std::string>();
}

std::size_t JsonCursor::choice(std::span<const std::string_view> known) const {
  const std::string word = text();
  const auto found = std::find(known.begin(), known.end(), word);
  if (found == known.end()) {
    expected(fmt::format("one of {}", fmt::join(known, ", ")));
  }
  return static_cast<std::size_t>(found - known.begin());
}

void JsonCursor::read_numbers(std::span<double> out, const Range& range) const {
  if (!value_->is_array() || value_->size() != out.size()) {
    expected(fmt::format("an array of {} numbers", out.size()));
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Json& item = (*value_)[i];
    const double value = item.is_number() ? item.get<double>() : 2 * range.max;
    if (!(value >= range.min && value <= range.max)) {
      JsonCursor(item, file_, fmt::format("{}/{}", path_, i))
          .expected(fmt::format("a number {}", range.text));
    }
    out[i] = value;
  }
}

Vec2 JsonCursor::vec2(const Range& range) const {
  return Vec2(vec2d(range));
}

Imath::V2d JsonCursor::vec2d(const Range& range) const {
  std::array<double, 2> v{};
  read_numbers(v, range);
  return {v[0], v[1]};
}

Vec3 JsonCursor::vec3(const Range& range) const {
  return Vec3(vec3d(range));
}

Imath::V3d JsonCursor::vec3d(const Range& range) const {
  std::array<double, 3> v{};
  read_numbers(v, range);
  return {v[0], v[1], v[2]};
}

Vec3 JsonCursor::direction() const {
  const Vec3 v = vec3();
  const float length = v.length();
  if (!(length > 0) || !std::isfinite(length))
    expected("a direction, three numbers that are not all zero");
  return v / length;
}

Rgb JsonCursor::rgb(const Range& range) const {
  if (value_->is_number()) return Rgb(number(range));
  if (!value_->is_array() || value_->size() != 3) {
    expected(fmt::format("a number {} or an array of 3", range.text));
  }
  const Vec3 v = vec3(range);
  return {v.x, v.y, v.z};
}

std::vector<double> JsonCursor::numbers(std::size_t count, const Range& range) const {
  std::vector<double> v(count);
  read_numbers(v, range);
  return v;
}

}  // namespace psf::render
