// Reads the numbers of an OBJ file for their errors alone, line by line.
#include <fmt/format.h>

#include <array>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "formats/error.h"
#include "render/load_parts.h"

namespace psf::render {
namespace {

// Cuts the next word off the front of `rest`.
std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  const std::size_t end = std::min(rest.find_first_of(" \t\r", begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

class ObjCheck {
 public:
  ObjCheck(const std::string& path, std::string& text) : path_(path), whole_(text), text_(text) {}

  void run() {
    while (!text_.empty()) {
      ++line_;
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      check_line(text_.substr(0, end));
      text_.remove_prefix(std::min(end + 1, text_.size()));
    }
    for (const Kind& kind : kinds_) {
      if (kind.largest > kind.count) {
        line_ = kind.largest_line;
        fail(
            fmt::format("the face names {} {}, there are {}", kind.name, kind.largest, kind.count));
      }
    }
  }

 private:
  struct Kind {
    const char* name;
    std::int64_t count = 0;
    std::int64_t largest = 0;  // index that any face names, from 1
    std::size_t largest_line = 0;
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::bad_input, fmt::format("{}:{}: {}", path_, line_, what));
  }

  // From a comment to the end of its line.
  void blank(std::string_view comment) {
    const auto begin = static_cast<std::size_t>(comment.data() - whole_.data());
    for (std::size_t i = begin; i < whole_.size() && whole_[i] != '\n'; ++i) whole_[i] = ' ';
  }

  void check_line(std::string_view line) {
    const std::string_view keyword = next_word(line);
    if (keyword == "v") return check_numbers(line, kinds_[0], 3);
    if (keyword == "vt") return check_numbers(line, kinds_[1], 1);
    if (keyword == "vn") return check_numbers(line, kinds_[2], 3);
    if (keyword == "f") check_face(line);
  }

  void check_numbers(std::string_view line, Kind& kind, int least) {
    ++kind.count;
    int numbers = 0;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
      if (word[0] == '#') {
        blank(word);
        break;
      }
      const std::string_view digits = word.substr(word[0] == '+' ? 1 : 0);
      double value = 0;
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) {
        fail(fmt::format("{} {}: \"{}\" is not a number", kind.name, kind.count, word));
      }
      if (error != std::errc() || !(std::abs(value) <= FLT_MAX)) {
        fail(fmt::format("{} {} is not finite or too large: {}", kind.name, kind.count, word));
      }
      ++numbers;
    }
    if (numbers < least) {
      fail(fmt::format("{} {} has {} numbers, it needs {}", kind.name, kind.count, numbers, least));
    }
  }

  // Words v, v/t, v//n or v/t/n; negative ones count back from the last.
  void check_face(std::string_view line) {
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
      if (word[0] == '#') return blank(word);
      std::string_view rest = word;
      for (std::size_t k = 0; k < kinds_.size(); ++k) {
        const std::size_t end = std::min(rest.find('/'), rest.size());
        const std::string_view digits = rest.substr(0, end);
        if (!digits.empty() || k == 0) check_index(word, digits, kinds_[k]);
        if (end == rest.size()) break;
        rest.remove_prefix(end + 1);
      }
    }
  }

  void check_index(std::string_view word, std::string_view digits, Kind& kind) {
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (error != std::errc() || end != digits.data() + digits.size() || index == 0) {
      fail(fmt::format("the face's corner \"{}\" is no index, they start with 1", word));
    }
    if (index < -kind.count) {
      fail(fmt::format("the face names {} {}, there are {} before it", kind.name, index,
                       kind.count));
    }
    if (index > kind.largest) {
      kind.largest = index;
      kind.largest_line = line_;
    }
  }

  const std::string& path_;
  std::string& whole_;
  std::string_view text_;  // what of it is still to be read
  std::size_t line_ = 0;
  std::array<Kind, 3> kinds_{Kind{"vertex"}, Kind{"texture coordinate"}, Kind{"normal"}};
};

}  // namespace

void check_obj(const std::string& path, std::string& text) {
  ObjCheck(path, text).run();
}

}  // namespace psf::render
