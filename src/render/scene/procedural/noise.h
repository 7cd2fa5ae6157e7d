// Gradient noise over space, from a seed.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/vec.h"
#include "render/sample/sampler_hash.h"

namespace psf::render {

// Smooth, 0 at points of the integer lattice, within about [-1, 1] (K. Perlin 2002, "Improving
// Noise"). Hashed instead of permuted, so it does not repeat.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : seed_(mix(seed ^ kGolden)) {}

  [[nodiscard]] double operator()(const Imath::V3d& p) const {
    const Imath::V3d low(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    const Imath::V3d f = p - low, s(fade(f.x), fade(f.y), fade(f.z));
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Imath::V3d step(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
      const double weight = (step.x > 0 ? s.x : 1 - s.x) * (step.y > 0 ? s.y : 1 - s.y) *
                            (step.z > 0 ? s.z : 1 - s.z);
      sum += weight * slope(low + step, f - step);
    }
    return sum;
  }
  // Three noises that have nothing to do with each other.
  [[nodiscard]] Imath::V3d vector(const Imath::V3d& p) const {
    return {(*this)(p), (*this)(p + Imath::V3d(101.3, 7.7, 55.1)),
            (*this)(p + Imath::V3d(-31.9, 211.5, 3.3))};
  }

 private:
  static double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

  // At `from` a lattice point whose gradient is one of the twelve from a cube to its edges.
  [[nodiscard]] double slope(const Imath::V3d& lattice, const Imath::V3d& from) const {
    std::uint64_t h = seed_;
    for (int axis = 0; axis < 3; ++axis)
      h = mix(h + kGolden * static_cast<std::uint64_t>(static_cast<std::int64_t>(lattice[axis])));
    const int axis = static_cast<int>(low(h) % 3);
    return ((h >> 40) & 1 ? from[(axis + 1) % 3] : -from[(axis + 1) % 3]) +
           ((h >> 41) & 1 ? from[(axis + 2) % 3] : -from[(axis + 2) % 3]);
  }

  std::uint64_t seed_;
};

}  // namespace psf::render
