// The header of a binary point cloud: Stanford's polygon file format with vertices alone.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace psf::exports {

struct PlyProperty {
  std::string_view type;  // float, double, uchar
  std::string name;
};

// The text of the header. The rows that follow it hold the properties in this order, packed and
// little-endian.
[[nodiscard]] inline std::string ply_header(std::string_view comment, std::uint64_t points,
                                            std::span<const PlyProperty> properties) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n", comment, points);
  for (const PlyProperty& property : properties) {
    text += fmt::format("property {} {}\n", property.type, property.name);
  }
  return text + "end_header\n";
}

}  // namespace psf::exports
