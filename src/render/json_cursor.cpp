#include "render/json_cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "formats/error.h"

namespace psf::render {
namespace {

using nlohmann::json;

// "3:17", both from 1, of the byte at `offset`.
std::string line_and_column(const std::string& text, std::size_t offset) {
  const std::string_view before = std::string_view(text).substr(0, std::min(offset, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 = 0
  return fmt::format("{}:{}", line, before.size() - line_start + 1);
}

// "syntax error while parsing value - unexpected '}'" of nlohmann's longer message.
std::string reason(const std::string& what) {
  std::size_t begin = what.find("] ");
  begin = begin == std::string::npos ? 0 : begin + 2;
  const std::size_t column = what.find("column", begin);
  if (column != std::string::npos && what.find(": ", column) != std::string::npos) {
    begin = what.find(": ", column) + 2;
  }
  return what.substr(begin);
}

std::string quoted(const json& value) {
  constexpr std::size_t kMost = 60;
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
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

// The line of a value, from 1, by its path in the document; 0 where the file is no text of JSON.
std::size_t line_of(const std::string& file, const std::string& path) {
  struct Around {
    std::string path;
    bool is_array;
    std::size_t items = 0;
  };
  std::ifstream in(file, std::ios::binary);
  std::vector<Around> around;
  std::string key;
  std::streamoff end = 0;
  const auto watch = [&](int, json::parse_event_t event, json& parsed) {
    using Event = json::parse_event_t;
    if (event == Event::key) {
      key = parsed.get<std::string>();
    } else if (event == Event::object_end || event == Event::array_end) {
      around.pop_back();
    } else {
      std::string place;
      if (!around.empty()) {
        Around& a = around.back();
        place = fmt::format("{}/{}", a.path, a.is_array ? std::to_string(a.items++) : key);
      }
      if (place == path) {
        // What ends a number is read with it.
        end = in.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in);
        if (parsed.is_number()) --end;
      }
      if (event != Event::value) around.push_back({std::move(place), event == Event::array_start});
    }
    return event != Event::value;  // nothing is kept
  };
  if (json::parse(in, watch, false).is_discarded()) return 0;
  in.clear();
  in.seekg(0);
  std::size_t lines = 1;
  for (std::streamoff k = 0; k < end; ++k) lines += in.get() == '\n' ? 1u : 0u;
  return lines;
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

json read_json(const std::string& path) {
  if (std::filesystem::is_directory(path))
    throw Error(ErrorCode::io, path + ": is a folder, a file is needed");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw Error(ErrorCode::io, fmt::format("{}: cannot open: {}", path, std::strerror(errno)));
  return parse_json({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}, path);
}

json parse_json(const std::string& text, const std::string& path) {
  std::vector<std::set<std::string>> keys;  // of the objects around the current place
  std::string doubled;
  const auto watch = [&](int, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key &&
        !keys.back().insert(parsed.get<std::string>()).second) {
      doubled = parsed.get<std::string>();
    }
    return true;
  };
  try {
    json document = json::parse(text, watch);
    if (!doubled.empty()) {
      throw Error(ErrorCode::bad_input,
                  fmt::format("{}: the key \"{}\" is twice in one object", path, doubled));
    }
    return document;
  } catch (const json::parse_error& error) {
    const std::size_t offset = error.byte == 0 ? 0 : error.byte - 1;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}:{}: malformed JSON: {}", path, line_and_column(text, offset),
                            reason(error.what())));
  } catch (const json::exception& error) {
    // A number out of range has no place, but its text is in the message, in quotes.
    const std::string what = reason(error.what());
    const std::size_t begin = what.find('\'') + 1, end = what.rfind('\'');
    const bool quoted = begin > 0 && end > begin;
    const std::size_t offset = quoted ? text.find(what.substr(begin, end - begin)) : 0;
    throw Error(ErrorCode::bad_input, fmt::format("{}:{}: malformed JSON: {}", path,
                                                  line_and_column(text, offset), what));
  }
}

void JsonCursor::fail(const std::string& problem) const {
  throw Error(ErrorCode::bad_input, where_exactly() + ": " + problem);
}

std::string JsonCursor::where_exactly() const {
  const std::size_t line = line_of(file_, path_);
  return line == 0 ? where() : fmt::format("{}:{}: {}", file_, line, path());
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
    const json& item = (*value_)[i];
    const double value = item.is_number() ? item.get<double>() : 2 * range.max;
    if (!(value >= range.min && value <= range.max)) {
      JsonCursor(item, file_, fmt::format("{}/{}", path_, i))
          .expected(fmt::format("a number {}", range.text));
    }
    out[i] = value;
  }
}

Vec2 JsonCursor::vec2(const Range& range) const {
  std::array<double, 2> v{};
  read_numbers(v, range);
  return {static_cast<float>(v[0]), static_cast<float>(v[1])};
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
