// The values that are averaged: c_j, or c_j / rho_j under demodulation; and the area of a record
// for [disk].
#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace psf::filter {

// c / rho by component. Components where rho is 0 or less are not divided, nor multiplied by
// remodulate().
[[nodiscard]] inline Rgb demodulate(const Rgb& c, const Rgb& rho) {
  const auto divide = [](float v, float by) { return by > 0 ? v / by : v; };
  return {divide(c.x, rho.x), divide(c.y, rho.y), divide(c.z, rho.z)};
}
[[nodiscard]] inline Rgb remodulate(const Rgb& v, const Rgb& rho) {
  const auto multiply = [](float c, float by) { return by > 0 ? c * by : c; };
  return {multiply(v.x, rho.x), multiply(v.y, rho.y), multiply(v.z, rho.z)};
}

// The least cosine that surface_area() uses. With a smaller one, the area of a grazing record would
// outweigh all others.
inline constexpr float kSmallestCosine = 0.01f;

// A_j of [disk]: the surface area that a record represents, squared world units.
[[nodiscard]] inline double surface_area(double angle_per_pixel, double distance,
                                         const Vec3& normal, const Vec3& direction,
                                         double samples_per_pixel) {
  const double side = angle_per_pixel * distance;
  const double cosine = std::max(std::abs(dot(normal, direction)), kSmallestCosine);
  return side * side / (cosine * samples_per_pixel);
}

}  // namespace psf::filter
