// The vectors and colours of the whole project: Imath's, under our names.
#pragma once

#include <ImathColor.h>
#include <ImathMatrix.h>
#include <ImathVec.h>

#include <cmath>

namespace psf {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
using Rgb = Imath::C3f;  // linear, Rec. 709 primaries
// Imath multiplies row vectors from the left: p * m, translation in the last row.
using Mat4 = Imath::M44f;

[[nodiscard]] inline float dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return a.cross(b);
}
[[nodiscard]] inline float length_sq(const Vec3& v) {
  return dot(v, v);
}

// Two unit vectors, orthogonal to the unit vector n and to each other. Duff et al. 2017, "Building an
// Orthonormal Basis, Revisited".
inline void complete_basis(const Vec3& n, Vec3& s, Vec3& t) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1 / (sign + n.z);
  const float b = n.x * n.y * a;
  s = Vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x);
  t = Vec3(b, sign + n.y * n.y * a, -n.y);
}

[[nodiscard]] inline float luminance(const Rgb& c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}
[[nodiscard]] inline float max_component(const Rgb& c) {
  return std::max(c.x, std::max(c.y, c.z));
}
[[nodiscard]] inline bool is_black(const Rgb& c) {
  return c.x == 0 && c.y == 0 && c.z == 0;
}
[[nodiscard]] inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace psf
