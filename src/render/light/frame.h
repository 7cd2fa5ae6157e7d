// Directions: orthonormal frames and the mappings from [0, 1)^2 to the sphere and its parts.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vec.h"

namespace psf::render {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kInvPi = std::numbers::inv_pi_v<float>;

// The unit vector along v, which must not be zero.
[[nodiscard]] inline Vec3 normalize(const Vec3& v) {
  return v * (1 / std::sqrt(length_sq(v)));
}

// The unit normal of a triangle with these edges, and twice its area as `size`. Both are 0 for a
// triangle without area. Computed in float, or in double where squares do not fit in a float.
struct TriangleNormal {
  Vec3 normal{0, 0, 0};
  float size = 0;

  TriangleNormal(const Vec3& edge1, const Vec3& edge2) {
    const Vec3 scaled = cross(edge1, edge2);
    const float scaled_sq = length_sq(scaled);
    if (scaled_sq > 1e-36f && scaled_sq < 1e38f) {
      size = std::sqrt(scaled_sq);
      normal = scaled * (1 / size);
      return;
    }
    const Imath::V3d wide = Imath::V3d(edge1).cross(Imath::V3d(edge2));
    const double wide_size = wide.length();
    size = static_cast<float>(wide_size);
    if (wide_size > 0) normal = Vec3(wide / wide_size);
  }
};

// An orthonormal frame whose z axis is n.
struct Frame {
  explicit Frame(const Vec3& normal) : n(normal) { complete_basis(n, s, t); }
  [[nodiscard]] Vec3 to_local(const Vec3& v) const { return {dot(v, s), dot(v, t), dot(v, n)}; }
  [[nodiscard]] Vec3 to_world(const Vec3& v) const { return s * v.x + t * v.y + n * v.z; }

  Vec3 s, t, n;
};

// The unit vector at height z whose squared distance from the axis is r_sq, at angle 2 pi u.
[[nodiscard]] inline Vec3 around_axis(float u, float r_sq, float z) {
  const float phi = 2 * kPi * u, r = std::sqrt(std::max(0.0f, r_sq));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// A direction in the hemisphere around +z with density cos / pi.
[[nodiscard]] inline Vec3 cosine_hemisphere(const Vec2& u) {
  return around_axis(u.x, u.y, std::sqrt(1 - u.y));
}

// A direction with density 1 / (4 pi).
[[nodiscard]] inline Vec3 uniform_sphere(const Vec2& u) {
  const float z = 1 - 2 * u.y;
  return around_axis(u.x, 4 * u.y * (1 - u.y), z);
}

// A uniform direction in the cone around +z, with density 1 / (2 pi height). `height` is 1 - cos of
// the half angle, which keeps narrow cones exact.
[[nodiscard]] inline Vec3 uniform_cone(const Vec2& u, float height) {
  const float h = u.y * height;
  return around_axis(u.x, h * (2 - h), 1 - h);
}
[[nodiscard]] inline float cone_pdf(float height) {
  return 1 / (2 * kPi * height);
}

// 1 - cos from sin^2, exact for small angles.
[[nodiscard]] inline float one_minus_cos(float sin_sq) {
  return sin_sq / (1 + std::sqrt(std::max(0.0f, 1 - sin_sq)));
}

// The weight of a sample with density a > 0, where b is the density of the other strategy (power
// heuristic, Veach 1997). The result is finite for a huge and for a zero b.
[[nodiscard]] inline float mis_weight(float a, float b) {
  const float ratio = b / a;
  return 1 / (1 + ratio * ratio);
}

}  // namespace psf::render
