// Medians of windows of a picture against sorting each window.
#include "study/median_around.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "catch.h"

namespace psf {
namespace {

TEST_CASE("median_around() is the middle of the sorted window that lies in the picture") {
  std::mt19937 random(5);
  const auto unit = [&random] { return std::uniform_real_distribution<float>(0, 1)(random); };
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {4, 3}, {17, 11}}) {
    std::vector<Rgb> picture;
    for (int k = 0; k < width * height; ++k) picture.emplace_back(unit(), unit(), 1e3f * unit());
    picture.back().y = std::numeric_limits<float>::quiet_NaN();
    picture[picture.size() / 2].x = std::numeric_limits<float>::infinity();
    const std::vector<Rgb> medians = study::median_around(picture, static_cast<std::size_t>(width));
    REQUIRE(medians.size() == picture.size());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) {
          std::vector<float> around;
          for (int k = 0; k < width * height; ++k) {
            const Rgb& value = picture[static_cast<std::size_t>(k)];
            const bool near = std::abs(k % width - x) <= 2 && std::abs(k / width - y) <= 2;
            if (near && std::isfinite(value.x + value.y + value.z)) around.push_back(value[c]);
          }
          std::sort(around.begin(), around.end());
          INFO(width << " x " << height << ", " << x << ", " << y << ", " << c);
          const float expected = around.empty() ? 0 : around[around.size() / 2];
          CHECK(medians[static_cast<std::size_t>(y * width + x)][c] == expected);
        }
      }
    }
  }
  CHECK(study::median_around({}, 0).empty());
}

}  // namespace
}  // namespace psf
