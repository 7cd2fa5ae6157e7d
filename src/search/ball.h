// Who is a neighbour: the one definition of distance and ball that every search and kernel shares.
#pragma once

#include <cstdint>

#include "core/vec.h"

namespace psf::search {

// Squared distance in float, in this order of operations and without fused multiply-add, so that
// every search and every kernel rounds the same way and finds the same neighbours.
[[nodiscard]] inline float distance_sq(float dx, float dy, float dz) {
  return dx * dx + dy * dy + dz * dz;
}
[[nodiscard]] inline float distance_sq(const Vec3& a, const Vec3& b) {
  return distance_sq(a.x - b.x, a.y - b.y, a.z - b.z);
}

// chi of [average] for j != i: strictly inside the ball. A point is always its own neighbour, which
// the caller has to add.
[[nodiscard]] inline bool chi_ball(float d_sq, float r_sq) {
  return d_sq < r_sq;
}

struct Neighbor {
  std::uint32_t index;  // number of the point in what was given to the search
  float d_sq;           // distance_sq to the centre, squared world units
  bool operator==(const Neighbor&) const = default;
};

}  // namespace psf::search
