// What the tests of the second pass share: a picture, and the pass over it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "filter/pixels/second_pass.h"

namespace psf::tests {

using filter::PixelPlane;
using filter::PixelStatistics;

// A picture with an edge, a gradient, pixels without vertices and without paths, and noise that
// its variance tells.
inline PixelStatistics picture(std::size_t width, std::size_t height, unsigned seed,
                               double scale = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  PixelStatistics s;
  const std::size_t size = width * height;
  s.width = width;
  s.height = height;
  s.paths.assign(size, 16);
  s.vertices.assign(size, 1);
  for (auto* three : {&s.radiance, &s.variance, &s.reflectance, &s.normal, &s.position}) {
    three->assign(3 * size, 0);
  }
  for (std::size_t k = 0; k < size; ++k) {
    const double x = static_cast<double>(k % width), y = static_cast<double>(k / width);
    const bool right = x > 0.6 * static_cast<double>(width);
    if (k % 37 == 5) s.paths[k] = 0;
    if (k % 23 == 3) s.vertices[k] = k % 2 == 0 ? 0.0f : 0.5f;
    s.normal[right ? k : 2 * size + k] = 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = c * size + k;
      const double noise = 0.05 * normal(random);
      s.reflectance[at] = static_cast<float>((right ? 0.2 : 0.7) + 0.02 * normal(random));
      s.variance[at] = static_cast<float>(scale * scale * 0.0025 * std::exp(0.5 * normal(random)));
      s.radiance[at] = static_cast<float>(
          scale * ((right ? 1.5 : 0.4) + 0.01 * y + 0.1 * static_cast<double>(c) + noise));
    }
    s.position[k] = static_cast<float>(0.1 * x + (right ? 500 : 0));
    s.position[size + k] = static_cast<float>(0.13 * y);
    s.position[2 * size + k] = static_cast<float>(right ? 0.03 * y : 7);
  }
  return s;
}

// The three colours of `s` after the second pass.
inline std::vector<float> passed(const PixelStatistics& s) {
  std::vector<float> values = s.radiance;
  const std::size_t size = s.paths.size();
  std::vector<PixelPlane> planes;
  for (std::size_t c = 0; c < 3; ++c) {
    planes.push_back({std::span(values).subspan(c * size, size), c});
  }
  filter::second_pass(s, planes);
  return values;
}

}  // namespace psf::tests
