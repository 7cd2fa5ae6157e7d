// In which colour a free path is sampled.
#pragma once

#include <cmath>

#include "core/vec.h"

namespace psf::render {

// The probability of each channel, as what the path carries.
[[nodiscard]] inline Rgb channel_choice(const Rgb& carried) {
  const float sum = carried.x + carried.y + carried.z;
  return sum > 1e-30f && std::isfinite(sum) ? carried * (1 / sum) : Rgb(1.0f / 3);
}
// The channel that `u` in [0, 1) chooses.
[[nodiscard]] inline int channel_of(const Rgb& choice, float u) {
  return u < choice.x ? 0 : u < choice.x + choice.y ? 1 : 2;
}

}  // namespace psf::render
