// A medium that absorbs and scatters light between surfaces, as a scene describes it.
#pragma once

#include <memory>
#include <string>

#include "core/vec.h"

namespace psf::render {

class DensityGrid;

// Coefficients are per unit of length of the scene's space, by colour.
struct Medium {
  std::string name;
  Rgb sigma_a{0, 0, 0};  // absorption
  Rgb sigma_s{0, 0, 0};  // scattering
  // Mean cosine of Henyey and Greenstein's phase function (1941), -1 < g < 1: above 0 light is
  // scattered forward.
  float g = 0;
  // Multiplies both coefficients from place to place; null: the medium is the same everywhere. It
  // stands still, whatever moves around it.
  std::shared_ptr<const DensityGrid> density;

  // What is scattered of the light that meets something.
  [[nodiscard]] Rgb albedo() const {
    const auto part = [](float s, float a) { return s > 0 ? s / (s + a) : 0.0f; };
    return {part(sigma_s.x, sigma_a.x), part(sigma_s.y, sigma_a.y), part(sigma_s.z, sigma_a.z)};
  }
  [[nodiscard]] Rgb sigma_t() const { return sigma_a + sigma_s; }
};

}  // namespace psf::render
