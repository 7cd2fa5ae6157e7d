// Sums of values in double, and [average] or [disk] computed from them.
#pragma once

#include <cstdint>
#include <numbers>

#include "core/vec.h"

namespace psf::filter {

struct Sum {
  double x = 0, y = 0, z = 0;
  void add(const Rgb& v, double weight) {
    x += weight * double{v.x};
    y += weight * double{v.y};
    z += weight * double{v.z};
  }
  void add(const Sum& other, double weight) {
    x += weight * other.x;
    y += weight * other.y;
    z += weight * other.z;
  }
  [[nodiscard]] Rgb over(double divisor) const {
    return {static_cast<float>(x / divisor), static_cast<float>(y / divisor),
            static_cast<float>(z / divisor)};
  }
};

// [average], or [disk] where `disk` is set, from the `sum` of `count` > 0 values, which are
// multiplied by their areas for [disk]. Where the disk has no area it is the record's `own` value.
[[nodiscard]] inline Rgb quotient(const Sum& sum, std::uint32_t count, bool disk, float r_i,
                                  const Rgb& own) {
  if (!disk) return sum.over(count);
  if (!(r_i * r_i > 0)) return own;
  return sum.over(std::numbers::pi * double{r_i} * double{r_i});
}

}  // namespace psf::filter
