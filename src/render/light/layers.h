// Layers of the light: parts of c_i and u_i that add up to them, by the lights that light comes
// from, by its bounces, or by the lobes at x_i.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"

namespace psf::render {

enum class LayerKind : std::uint8_t {
  none,
  lights,   // one for each name among the lights, and `sky`
  bounces,  // c: `direct`, from a light to x_i, and `indirect`; u: `camera`
  lobes     // c: `diffuse` and `glossy`, the lobe of x_i that scattered it; u: `camera`
};

// What is behind the dot of contribution.NAME and unfiltered.NAME, and which of them it has.
struct LayerInfo {
  std::string name;
  bool contribution = true, unfiltered = true;
};

// The layers of one path, by number; to be added to. Both are empty where none are wanted.
struct LayerSums {
  std::span<Rgb> contribution, unfiltered;  // c_i and u_i
};

}  // namespace psf::render
