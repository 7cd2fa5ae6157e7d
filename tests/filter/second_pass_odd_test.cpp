// What is odd does no harm to the second pass.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "catch.h"
#include "filter/pixels/second_pass.h"
#include "second_pass_setup.h"

namespace psf {
namespace {

using filter::PixelStatistics;
using tests::passed;
using tests::picture;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST_CASE("Pixels that are not finite count nowhere and stay") {
  constexpr std::array<std::size_t, 4> kOdd = {820, 420, 220, 30};
  PixelStatistics s = picture(40, 40, 7);
  const std::vector<float> before = passed(s);
  s.radiance[820] = kInfinity;
  s.radiance[1600 + 420] = std::numeric_limits<float>::quiet_NaN();
  s.variance[220] = kInfinity;
  s.radiance[30] = 1e30f;
  const std::vector<float> after = passed(s);
  for (std::size_t k = 0; k < after.size(); ++k) {
    const std::size_t pixel = k % 1600;
    if (std::find(kOdd.begin(), kOdd.end(), pixel) != kOdd.end()) {
      CHECK((after[k] == s.radiance[k] || std::isnan(s.radiance[k])));
    } else {
      const bool is_near = std::any_of(kOdd.begin(), kOdd.end(), [&](std::size_t odd) {
        const auto away = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
        return away(pixel % 40, odd % 40) <= 8 && away(pixel / 40, odd / 40) <= 8;
      });
      CHECK(std::abs(after[k] - before[k]) < (is_near ? 0.3f : 3e-3f));
    }
  }
}

TEST_CASE("Places that are not finite or far away do no harm to the second pass") {
  PixelStatistics s = picture(40, 40, 8);
  for (const std::size_t k : {300u, 301u, 302u, 900u}) s.position[k] = 1e30f;
  for (const float value : passed(s)) CHECK(std::isfinite(value));
}

TEST_CASE("A black picture, one without paths and no picture stay as they are") {
  PixelStatistics black = picture(20, 20, 9);
  std::fill(black.radiance.begin(), black.radiance.end(), 0.0f);
  CHECK(passed(black) == black.radiance);
  PixelStatistics none = picture(20, 20, 10);
  std::fill(none.paths.begin(), none.paths.end(), std::uint64_t{0});
  CHECK(passed(none) == none.radiance);
  CHECK(passed(PixelStatistics()).empty());
}

TEST_CASE("One pixel however bright does not blur what is far from it") {
  PixelStatistics s = picture(40, 40, 13);
  const std::vector<float> before = passed(s);
  for (std::size_t at = 30; at < 4800; at += 1600) {
    s.radiance[at] = 1e9f;
    s.variance[at] = 1e17f;
  }
  const std::vector<float> after = passed(s);
  for (std::size_t k = 0; k < after.size(); ++k) {
    if (k % 1600 / 40 > 8) CHECK(std::abs(after[k] - before[k]) < 3e-3f);
  }
}

TEST_CASE("Reflectances and normals that are finite but absurd do no harm") {
  PixelStatistics s = picture(40, 40, 14);
  const std::vector<float> before = passed(s);
  s.reflectance[300] = 1e25f;
  s.normal[900] = -1e30f;
  const std::vector<float> after = passed(s);
  for (std::size_t k = 0; k < after.size(); ++k) CHECK(std::abs(after[k] - before[k]) < 0.3f);
}

TEST_CASE("Light near the largest floats stays finite") {
  PixelStatistics s = picture(40, 40, 15);
  for (float& value : s.radiance) value *= 1e38f;
  std::fill(s.variance.begin(), s.variance.end(), 0.0f);
  for (const float value : passed(s)) CHECK(std::isfinite(value));
}

}  // namespace
}  // namespace psf
