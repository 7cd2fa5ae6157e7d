// Relief: frames out of texture coordinates, and slopes out of heights.
#include "render/light/relief.h"

#include "render/light/frame.h"

namespace psf::render {
namespace {

// Of a vector that may be 0: then `otherwise`.
Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const float length = v.length();
  return length > 0 && std::isfinite(length) ? v * (1 / length) : otherwise;
}

// One number of a texel: the mean of its colours.
float height_at(const Texture& heights, const Vec2& uv) {
  const Rgb c = heights.at(uv);
  return (c.x + c.y + c.z) * (1.0f / 3);
}

}  // namespace

Chart Chart::of_triangle(const Vec3& edge1, const Vec3& edge2, const Vec2& uv1, const Vec2& uv2) {
  const float determinant = uv1.x * uv2.y - uv1.y * uv2.x;
  if (determinant == 0 || !std::isfinite(1 / determinant)) return {};
  return {(edge1 * uv2.y - edge2 * uv1.y) * (1 / determinant),
          (edge2 * uv1.x - edge1 * uv2.x) * (1 / determinant)};
}

Chart Chart::of_sphere(const Vec3& n, float radius) {
  // Of surface.h's longitude and latitude, which are 2 pi u and pi v.
  const float ring = std::sqrt(n.x * n.x + n.z * n.z);
  if (!(ring > 0)) return {};
  return {Vec3(-n.z, 0, n.x) * (2 * kPi * radius),
          Vec3(-n.y * n.x / ring, ring, -n.y * n.z / ring) * (kPi * radius)};
}

Relief::Relief(const Material& material, const Scene& scene)
    : scale_(material.normal_scale), height_(material.bump_height) {
  const auto texture = [&](int index) {
    return index == kNone ? nullptr : &scene.textures[static_cast<std::size_t>(index)];
  };
  normals_ = texture(material.normal_texture);
  heights_ = texture(material.bump_texture);
}

Vec3 Relief::normal(const Vec3& normal, const Chart& chart, const Vec2& uv) const {
  Vec3 result = normal;
  if (normals_ != nullptr) result = mapped(result, chart, uv);
  if (heights_ != nullptr) result = bumped(result, chart, uv);
  return result;
}

Vec3 Relief::mapped(const Vec3& n, const Chart& chart, const Vec2& uv) const {
  const Vec3 along = chart.by_u - n * dot(n, chart.by_u);
  const Vec3 t = unit_or(along, Vec3(0, 0, 0));
  if (t == Vec3(0, 0, 0)) return n;
  Vec3 b = cross(n, t);
  if (dot(b, chart.by_v) < 0) b = -b;
  const Rgb texel = normals_->at(uv);
  const float x = (2 * texel.x - 1) * scale_, y = (2 * texel.y - 1) * scale_, z = 2 * texel.z - 1;
  return unit_or(t * x + b * y + n * z, n);
}

Vec3 Relief::bumped(const Vec3& n, const Chart& chart, const Vec2& uv) const {
  const Vec3 up = cross(chart.by_u, chart.by_v);
  const float area_sq = length_sq(up);
  if (!(area_sq > 0)) return n;
  // Half a texel to both sides: the slope of interpolated heights, which then has no steps.
  const float du = 0.5f / static_cast<float>(heights_->width());
  const float dv = 0.5f / static_cast<float>(heights_->height());
  const float slope_u =
      height_ / (2 * du) *
      (height_at(*heights_, uv + Vec2(du, 0)) - height_at(*heights_, uv - Vec2(du, 0)));
  const float slope_v =
      height_ / (2 * dv) *
      (height_at(*heights_, uv + Vec2(0, dv)) - height_at(*heights_, uv - Vec2(0, dv)));
  const Vec3 gradient =
      (cross(chart.by_v, up) * slope_u + cross(up, chart.by_u) * slope_v) * (1 / area_sq);
  return unit_or(n - (gradient - n * dot(n, gradient)), n);
}

}  // namespace psf::render
