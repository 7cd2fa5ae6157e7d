// The colour maps are those that are published.
#include "metrics/color_map.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <cmath>
#include <string>

#include "catch.h"
#include "core/error.h"
#include "film/display.h"

using psf::metrics::mapped_color;

TEST_CASE("every 16th part of a colour map is OpenImageIO's, what is between them nearly") {
  constexpr int kStep = 60, kWidth = 16 * kStep + 1;
  OIIO::ImageBuf ramp(OIIO::ImageSpec(kWidth, 1, 1, OIIO::TypeDesc::FLOAT));
  for (int x = 0; x < kWidth; ++x) {
    const float value[1] = {static_cast<float>(x) / (kWidth - 1)};
    ramp.setpixel(x, 0, value);
  }
  for (const char* name : psf::metrics::kColorMaps) {
    const OIIO::ImageBuf expected = OIIO::ImageBufAlgo::color_map(ramp, 0, name);
    REQUIRE(!expected.has_error());
    for (int x = 0; x < kWidth; ++x) {
      const auto color = mapped_color(name, static_cast<double>(x) / (kWidth - 1));
      for (int k = 0; k < 3; ++k) {
        const float linear = expected.getchannel(x, 0, 0, k);
        // OpenImageIO has straight lines in linear light, ours are in what is shown; measured 5.4,
        // and 15.1 where turbo is steep.
        const double between = std::string(name) == "turbo" ? 15.6 : 5.9;
        const double allowed = x % kStep == 0 ? 0.51 : between;
        INFO(name << " at " << x << " channel " << k);
        REQUIRE(std::abs(color[static_cast<std::size_t>(k)] -
                         255 * psf::film::srgb_from_linear(linear)) < allowed);
      }
    }
  }
}

TEST_CASE("a colour map ends where its range does, and has a name") {
  CHECK(mapped_color("viridis", -1) == mapped_color("viridis", 0));
  CHECK(mapped_color("viridis", 2) == std::array<std::uint8_t, 3>{253, 231, 37});
  CHECK_THROWS_AS(mapped_color("jet", 0), psf::Error);
}
