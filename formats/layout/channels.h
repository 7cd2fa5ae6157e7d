// The channels of version 1 that have a meaning: README.md, "Channels", in its order. pvb.h,
// pvb.py, that table and what psf-render writes are checked against this one by tests.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "formats/layout/head.h"

namespace psf::formats {

struct ChannelInfo {
  std::string_view name;
  Type type;
  std::uint8_t components;
  bool required;            // a dump without it cannot be filtered
  std::string_view unit;    // "world" units, "radiance", or "" for numbers without unit
  std::string_view symbol;  // of path space filtering, "" where it has none
};

inline constexpr std::array<ChannelInfo, 22> kChannels = {{
    {"position", Type::f32, 3, true, "world", "x_i"},
    {"throughput", Type::f32, 3, true, "", "alpha_i"},
    {"contribution", Type::f32, 3, true, "radiance", "c_i"},
    {"distance", Type::f32, 1, true, "world", "d_i"},
    {"pixel", Type::u32, 1, true, "", ""},
    {"unfiltered", Type::f32, 3, false, "radiance", "u_i"},
    {"flags", Type::u8, 1, false, "", ""},
    {"normal", Type::f32, 3, false, "", "n_i"},
    {"reflectance", Type::f32, 3, false, "", "rho_i"},
    {"camera", Type::u16, 1, false, "", ""},
    {"visibility", Type::u32, 1, false, "", ""},
    {"hit_distance", Type::f32, 1, false, "world", "h_i"},
    {"direction", Type::f32, 3, false, "", "omega_i"},
    {"material", Type::u32, 1, false, "", ""},
    {"roughness", Type::f32, 1, false, "", "q_i"},
    {"film", Type::f32, 2, false, "", ""},
    {"lens", Type::f32, 2, false, "", ""},
    {"time", Type::f32, 1, false, "", ""},
    {"frame", Type::u32, 1, false, "", ""},
    {"alpha", Type::f32, 1, false, "", ""},
    {"kind", Type::u8, 1, false, "", ""},
    {"rest_position", Type::f32, 3, false, "world", ""},
}};

// The row of a channel; null where the name means nothing to version 1.
[[nodiscard]] constexpr const ChannelInfo* channel_info(std::string_view name) {
  for (const ChannelInfo& channel : kChannels) {
    if (channel.name == name) return &channel;
  }
  return nullptr;
}

}  // namespace psf::formats
