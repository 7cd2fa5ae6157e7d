// A medium that absorbs and scatters light between surfaces, as a scene describes it.
#pragma once

#include <string>

#include "core/vec.h"

namespace psf::render {

// The same everywhere. Coefficients are per unit of length of the scene's space, by colour.
struct Medium {
  std::string name;
  Rgb sigma_a{0, 0, 0};  // absorption
  Rgb sigma_s{0, 0, 0};  // scattering
  // Mean cosine of Henyey and Greenstein's phase function (1941), -1 < g < 1: above 0 light is
  // scattered forward.
  float g = 0;

  [[nodiscard]] Rgb sigma_t() const { return sigma_a + sigma_s; }
};

}  // namespace psf::render
