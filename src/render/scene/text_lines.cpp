#include "render/scene/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "render/scene/load_parts.h"
#include "render/scene/whole_file.h"

namespace psf::render {
namespace {

constexpr std::string_view kSpace = " \t\v\f";
constexpr std::size_t kLinesBetweenLooks = std::size_t{1} << 16;  // for an interrupt
constexpr std::size_t kMostNames = 16;  // a file of something else has a name in every line

// Bytes of the UTF-8 character at the front, 0 where there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string utf8_of_latin1(std::string_view text) {
  std::string utf8;
  utf8.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0 | (byte >> 6));
      utf8 += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return utf8;
}

// The bytes that utf8_of_latin1 was given; empty where it cannot have been given any.
std::string latin1_of_utf8(std::string_view text) {
  std::string latin1;
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text[0]);
    const std::size_t length = utf8_length(text);
    if (length == 0 || first > 0xC3) return {};
    latin1 +=
        length == 1
            ? text[0]
            : static_cast<char>(((first & 3) << 6) | (static_cast<unsigned char>(text[1]) & 0x3F));
    text.remove_prefix(length);
  }
  return latin1;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin);
}

// True where all of `word` was a number, which may be infinite.
bool parse(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return false;
  // from_chars leaves the value alone where it has no double: too large, or too small.
  if (error == std::errc::result_out_of_range)
    value = std::strtod(std::string(word).c_str(), nullptr);
  return true;
}

}  // namespace

TextLines::TextLines(const std::string& path) : path_(path), text_(read_whole<std::string>(path)) {
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
    throw Error(ErrorCode::bad_input,
                path + ": the text is UTF-16, save it as UTF-8 or plain ASCII");
  }
  const bool ascii =
      std::none_of(text_.begin(), text_.end(), [](char c) { return (c & 0x80) != 0; });
  if (!ascii && !is_utf8(text_)) text_ = utf8_of_latin1(text_);
}

std::size_t TextLines::find_line_end(std::size_t from) const {
  while (from < text_.size() && text_[from] != '\n' && text_[from] != '\r') ++from;
  return from;
}

bool TextLines::next() {
  while (at_ < text_.size()) {
    const std::size_t begin = at_;
    line_ = ++lines_;
    if (line_ % kLinesBetweenLooks == 0) stop_where_interrupted();
    bool comment = false;
    for (;;) {
      const std::size_t end = find_line_end(at_);
      rest_ = trimmed(std::string_view(text_).substr(begin, end - begin));
      comment = !rest_.empty() && rest_[0] == '#';
      const std::size_t breaks = text_.compare(end, 2, "\r\n") == 0 ? 2 : 1;
      at_ = std::min(end + breaks, text_.size());
      if (comment || rest_.empty() || text_[end - 1] != '\\' || at_ == text_.size()) break;
      if (rest_.find(" #") != std::string_view::npos || rest_.find("\t#") != std::string_view::npos)
        break;  // the backslash is part of a comment
      std::fill(text_.begin() + static_cast<std::ptrdiff_t>(end) - 1,
                text_.begin() + static_cast<std::ptrdiff_t>(at_), ' ');
      ++lines_;
    }
    statement_ = comment ? std::string_view() : word();
    if (!statement_.empty()) return true;
  }
  return false;
}

std::string_view TextLines::word() {
  const std::size_t begin = rest_.find_first_not_of(kSpace);
  if (begin == std::string_view::npos || rest_[begin] == '#') {
    rest_ = {};
    return {};
  }
  const std::size_t end = std::min(rest_.find_first_of(kSpace, begin), rest_.size());
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return word;
}

std::string_view TextLines::rest() const {
  return trimmed(rest_);
}

void TextLines::skip(std::size_t count) {
  rest_ = rest().substr(count);
}

float TextLines::number(std::string_view kind, std::size_t index) {
  return to_number(word(), kind, index);
}

float TextLines::to_number(std::string_view word, std::string_view kind, std::size_t index) const {
  return static_cast<float>(to_real(word, kind, index));
}

double TextLines::to_real(std::string_view word, std::string_view kind, std::size_t index) const {
  double value = 0;
  const bool good = parse(word, value);
  if (good && std::abs(value) <= double{FLT_MAX}) return value;
  std::string what(kind);
  if (index > 0) what += fmt::format(" {}", index);
  if (word.empty()) fail(what + " lacks a number");
  if (good) fail(fmt::format("{} is not finite or too large: {}", what, word));
  const bool comma = word.find(',') != std::string_view::npos;
  fail(fmt::format("{}: \"{}\" is not a number{}", what, word,
                   comma ? " (decimals take a point, numbers a space between)" : ""));
}

bool TextLines::is_number(std::string_view word) {
  double ignored = 0;
  return parse(word, ignored);
}

void TextLines::fail(const std::string& what) const {
  throw Error(ErrorCode::bad_input, fmt::format("{}:{}: {}", path_, line_, what));
}

void LeftOut::add(std::string_view name) {
  if (all_.contains(name)) return;
  all_.emplace(name);
  if (names_.size() < kMostNames) names_.emplace_back(name);
}

void LeftOut::add_statement(std::string_view statement) {
  const auto is_letter = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };
  const bool is_word = statement.size() <= 32 &&
                       !std::isdigit(static_cast<unsigned char>(statement[0])) &&
                       std::all_of(statement.begin(), statement.end(), is_letter);
  add(is_word ? statement : "lines that are no statement");
}

void LeftOut::warn(const std::string& path, Scene& scene) const {
  if (names_.empty()) return;
  std::string text = fmt::format("{}: left out: {}", path, fmt::join(names_, ", "));
  if (names_.size() < all_.size()) text += fmt::format(" and {} more", all_.size() - names_.size());
  scene.warnings.push_back(std::move(text));
}

std::string find_named(const std::string& beside, std::string_view name) {
  std::vector<std::string> candidates{std::string(name)};
  if (name.size() > 2 && (name[0] == '"' || name[0] == '\'') && name.back() == name[0])
    candidates.emplace_back(name.substr(1, name.size() - 2));
  if (name.find("\\ ") != std::string_view::npos) {
    std::string& plain = candidates.emplace_back(name);
    for (std::size_t at = plain.find("\\ "); at != std::string::npos; at = plain.find("\\ "))
      plain.erase(at, 1);
  }
  for (std::size_t i = 0, count = candidates.size(); i < count; ++i) {
    std::string bytes = latin1_of_utf8(candidates[i]);
    if (bytes != candidates[i] && !bytes.empty()) candidates.push_back(std::move(bytes));
  }
  for (const std::string& candidate : candidates) {
    std::error_code ignored;
    const auto status = std::filesystem::status(find_file(beside, candidate), ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) return candidate;
  }
  return {};
}

}  // namespace psf::render
