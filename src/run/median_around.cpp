#include "run/median_around.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace psf::run {
namespace {

constexpr std::size_t kReach = 2, kSide = 2 * kReach + 1;  // pixels

}  // namespace

std::vector<double> median_around(std::span<const double> values, std::size_t width) {
  std::vector<double> medians(values.size());
  const std::size_t height = width == 0 ? 0 : values.size() / width;
  core::parallel_for(height, 1, [&](std::size_t y, std::size_t) {
    std::array<double, kSide * kSide> around;
    for (std::size_t x = 0; x < width; ++x) {
      std::size_t count = 0;
      for (std::size_t v = y - std::min(y, kReach); v <= std::min(y + kReach, height - 1); ++v) {
        for (std::size_t u = x - std::min(x, kReach); u <= std::min(x + kReach, width - 1); ++u) {
          const double value = values[v * width + u];
          if (std::isfinite(value)) around[count++] = value;
        }
      }
      if (count == 0) continue;
      const auto middle = around.begin() + static_cast<std::ptrdiff_t>(count / 2);
      std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(count));
      medians[y * width + x] = *middle;
    }
  });
  return medians;
}

}  // namespace psf::run
