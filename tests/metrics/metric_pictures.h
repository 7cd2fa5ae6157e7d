// Pictures to measure.
#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "core/vec.h"

namespace psf::tests {

// Edges, gradients, colours and lamps far above white.
inline std::vector<Rgb> painted(std::size_t width, std::size_t height) {
  std::vector<Rgb> picture;
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(width);
      const float v = static_cast<float>(y) / static_cast<float>(height);
      Rgb color(u, 0.5f * v, 0.3f + 0.2f * std::sin(40 * u * v));
      if (x > width / 2 && y > height / 3) color = Rgb(0.05f, 0.6f, 0.1f);
      if ((x + y) % 17 == 0) color = Rgb(0.01f);
      if (x < width / 8 && y < height / 8) color = Rgb(12, 10, 3);
      picture.push_back(color);
    }
  }
  return picture;
}

// Every channel times 1 + amplitude * [-1, 1].
inline std::vector<Rgb> noisy(std::vector<Rgb> picture, float amplitude, unsigned seed = 1) {
  std::mt19937 numbers(seed);  // its numbers are the same everywhere, a distribution's are not
  for (Rgb& color : picture) {
    for (int k = 0; k < 3; ++k) {
      color[k] *= 1 + amplitude * (2 * (static_cast<float>(numbers() >> 8) / 0x1p24f) - 1);
    }
  }
  return picture;
}

}  // namespace psf::tests
