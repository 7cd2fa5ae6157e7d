// Numbers as text for people, and lists that people write.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace psf::core {

// 1234567 becomes "1,234,567".
inline std::string with_commas(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t left = text.size(); left > 3;) {
    left -= 3;
    text.insert(left, ",");
  }
  return text;
}

// The parts of `text` with `by` between; one empty part where it is empty.
inline std::vector<std::string> split(std::string_view text, char by) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(by, begin), text.size());
    parts.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// A number with its noun: "1 pass", "2 passes".
inline std::string counted(std::uint64_t count, const char* one, const char* many) {
  return with_commas(count) + " " + (count == 1 ? one : many);
}

// A number of bytes as mebibytes, rounded up: "1,234 MiB".
inline std::string in_mebibytes(std::uint64_t bytes) {
  constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
  return with_commas((bytes + kMebibyte - 1) / kMebibyte) + " MiB";
}

}  // namespace psf::core
