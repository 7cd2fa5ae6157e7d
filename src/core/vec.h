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
