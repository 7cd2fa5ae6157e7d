// [radius]: the radii of the balls, which shrink as samples accumulate.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/records.h"

namespace psf::filter {

// r0 / sqrt(n^delta). Before the first sample per pixel is complete n counts as 1: no radius
// exceeds r0 f_i.
[[nodiscard]] inline double radius_scale(const Radius& radius, double n) {
  return radius.r0 / std::sqrt(std::pow(std::max(1.0, n), radius.delta));
}

// f_i of record i; d_i below 0 counts as 0. `distance` is read unless the basis is `world`.
[[nodiscard]] inline double basis_of(const Radius& radius, const Records& records,
                                     const Block& block, std::size_t i) {
  if (radius.basis == RadiusBasis::world) return 1;
  const double d = std::max(0.0, double{records.distance[i]});
  if (radius.basis == RadiusBasis::distance) return d;
  return d * block.cameras[records.camera.empty() ? 0 : records.camera[i]].angle_per_pixel;
}

// Writes r_i of every record to `out`, in world units.
inline void radii(const Radius& radius, const Records& records, const Block& block,
                  std::vector<float>& out) {
  const double scale = radius_scale(radius, block.n);
  out.resize(records.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<float>(scale * basis_of(radius, records, block, i));
  }
}

}  // namespace psf::filter
