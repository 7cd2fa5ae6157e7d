#include "metrics/color_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "core/error.h"

namespace psf::metrics {
namespace {

// Every 16th part of each map, 0xRRGGBB; between them the maps are straight enough.
constexpr int kSteps = 16;
constexpr std::uint32_t kColors[][kSteps + 1] = {
    {0x000004, 0x0b0724, 0x210c4a, 0x3d0965, 0x57106e, 0x71196e, 0x8a226a, 0xa32c61, 0xbc3754,
     0xd24644, 0xe45a31, 0xf1731d, 0xf98e09, 0xfcac11, 0xf9cb35, 0xf2ea69, 0xfcffa4},
    {0x000004, 0x0a0822, 0x1d1147, 0x36106b, 0x51127c, 0x6a1c81, 0x832681, 0x9c2e7f, 0xb73779,
     0xd0416f, 0xe75263, 0xf56b5c, 0xfc8961, 0xfea772, 0xfec488, 0xfde2a3, 0xfcfdbf},
    {0x0d0887, 0x310597, 0x4c02a1, 0x6600a7, 0x7e03a8, 0x9511a1, 0xaa2395, 0xbc3587, 0xcc4778,
     0xda5a6a, 0xe66c5c, 0xf0804e, 0xf89540, 0xfdac33, 0xfdc527, 0xf8df25, 0xf0f921},
    {0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c,
     0x1fa088, 0x28ae80, 0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725},
    {0x30123b, 0x4040a2, 0x466be3, 0x4294ff, 0x28bceb, 0x18ddc2, 0x32f298, 0x6dfe62, 0xa4fc3c,
     0xcdec34, 0xeecf3a, 0xfdac34, 0xfb7e21, 0xeb500e, 0xd02f05, 0xa91601, 0x7a0403}};
static_assert(std::size(kColors) == std::size(kColorMaps));

}  // namespace

std::array<std::uint8_t, 3> mapped_color(std::string_view map, double value) {
  const auto* const name = std::find(std::begin(kColorMaps), std::end(kColorMaps), map);
  if (name == std::end(kColorMaps)) {
    throw Error(ErrorCode::usage, std::string(map) + ": no colour map");
  }
  const auto& colors = kColors[name - std::begin(kColorMaps)];
  const double place = std::clamp(value, 0.0, 1.0) * kSteps;
  const int part = std::min(static_cast<int>(place), kSteps - 1);
  std::array<std::uint8_t, 3> color{};
  for (unsigned k = 0; k < 3; ++k) {
    const auto at = [&](int knot) { return double((colors[knot] >> (16 - 8 * k)) & 0xff); };
    color[k] =
        static_cast<std::uint8_t>(std::lround(std::lerp(at(part), at(part + 1), place - part)));
  }
  return color;
}

}  // namespace psf::metrics
