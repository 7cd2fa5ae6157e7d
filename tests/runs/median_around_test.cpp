// Medians of windows of a picture against sorting each window.
#include "run/median_around.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "catch.h"

namespace psf {
namespace {

TEST_CASE("median_around() is the middle of the sorted window that lies in the picture") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {4, 3}, {17, 11}}) {
    std::vector<double> values;
    for (int k = 0; k < width * height; ++k) values.push_back(unit(random));
    values.back() = std::numeric_limits<double>::quiet_NaN();
    values[values.size() / 2] = std::numeric_limits<double>::infinity();
    const auto medians = run::median_around(values, static_cast<std::size_t>(width));
    REQUIRE(medians.size() == values.size());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        std::vector<double> around;
        for (int k = 0; k < width * height; ++k) {
          const double value = values[static_cast<std::size_t>(k)];
          const bool near = std::abs(k % width - x) <= 2 && std::abs(k / width - y) <= 2;
          if (near && std::isfinite(value)) around.push_back(value);
        }
        std::sort(around.begin(), around.end());
        INFO(width << " x " << height << ", " << x << ", " << y);
        const double expected = around.empty() ? 0 : around[around.size() / 2];
        CHECK(medians[static_cast<std::size_t>(y * width + x)] == expected);
      }
    }
  }
  CHECK(run::median_around({}, 0).empty());
}

}  // namespace
}  // namespace psf
