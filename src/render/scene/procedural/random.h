// Random numbers and directions of shapes that are grown from a seed.
#pragma once

#include <cstdint>

#include "core/vec.h"
#include "render/sample/sampler_hash.h"

namespace psf::render {

// The same numbers on every machine: integers are hashed, and directions need no more than products
// and square roots, which are exact to the last bit everywhere. Numbers that belong together are drawn
// in statements of their own, since compilers differ in the order of arguments; the last comes first.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix(seed + kGolden)) {}

  [[nodiscard]] double unit() {  // in [0, 1)
    state_ += kGolden;
    return static_cast<double>(mix(state_) >> 11) * 0x1p-53;
  }
  [[nodiscard]] double between(double low, double high) { return low + (high - low) * unit(); }

  [[nodiscard]] Imath::V2d in_disk() {
    for (;;) {
      const double y = between(-1, 1), x = between(-1, 1);
      if (x * x + y * y <= 1) return {x, y};
    }
  }
  [[nodiscard]] Imath::V2d on_circle() {
    for (;;) {
      const Imath::V2d p = in_disk();
      const double length_sq = p.x * p.x + p.y * p.y;
      if (length_sq > 1e-4) return p * (1 / std::sqrt(length_sq));
    }
  }
  [[nodiscard]] Imath::V3d on_sphere() {
    for (;;) {
      const double z = between(-1, 1), y = between(-1, 1), x = between(-1, 1);
      const Imath::V3d p(x, y, z);
      const double length_sq = p.x * p.x + p.y * p.y + p.z * p.z;
      if (length_sq > 1e-4 && length_sq <= 1) return p * (1 / std::sqrt(length_sq));
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace psf::render
