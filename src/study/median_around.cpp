#include "study/median_around.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"

namespace psf::study {
namespace {

constexpr std::size_t kReach = 2, kSide = 2 * kReach + 1;  // pixels

}  // namespace

std::vector<Rgb> median_around(std::span<const Rgb> picture, std::size_t width) {
  std::vector<Rgb> medians(picture.size(), Rgb(0, 0, 0));
  if (picture.empty()) return medians;
  const std::size_t height = picture.size() / width;
  core::parallel_for(height, 1, [&](std::size_t y, std::size_t) {
    std::array<std::array<float, kSide * kSide>, 3> around;
    for (std::size_t x = 0; x < width; ++x) {
      std::size_t count = 0;
      for (std::size_t v = y - std::min(y, kReach); v <= std::min(y + kReach, height - 1); ++v) {
        for (std::size_t u = x - std::min(x, kReach); u <= std::min(x + kReach, width - 1); ++u) {
          const Rgb& value = picture[v * width + u];
          if (!is_finite(value)) continue;
          for (int c = 0; c < 3; ++c) around[static_cast<std::size_t>(c)][count] = value[c];
          ++count;
        }
      }
      if (count == 0) continue;
      for (int c = 0; c < 3; ++c) {
        const auto first = around[static_cast<std::size_t>(c)].begin();
        const auto middle = first + static_cast<std::ptrdiff_t>(count / 2);
        std::nth_element(first, middle, first + static_cast<std::ptrdiff_t>(count));
        medians[y * width + x][c] = *middle;
      }
    }
  });
  return medians;
}

}  // namespace psf::study
