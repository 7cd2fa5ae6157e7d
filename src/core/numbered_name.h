// Names of files of which there is one a frame: "####" in a name stands for the frame's number.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace psf::core {

// What stands for the number of a frame in the name of a file, four digits or more.
inline constexpr std::string_view kNumberMark = "####";

[[nodiscard]] inline bool is_numbered(const std::string& path) {
  return path.find(kNumberMark) != std::string::npos;
}

// The name with the frame's number; a name without the mark as it is.
[[nodiscard]] inline std::string numbered(std::string path, std::uint32_t frame) {
  const std::size_t at = path.find(kNumberMark);
  if (at == std::string::npos) return path;
  std::string digits = std::to_string(frame);
  if (digits.size() < kNumberMark.size()) digits.insert(0, kNumberMark.size() - digits.size(), '0');
  return path.replace(at, kNumberMark.size(), digits);
}

}  // namespace psf::core
