// Normal and bump maps: the shading normal of a surface that has pictures for its relief.
#pragma once

#include "core/vec.h"
#include "render/scene/scene.h"

namespace psf::render {

// How texture coordinates lie on a surface: its position's derivatives by u and v.
struct Chart {
  Vec3 by_u{0, 0, 0}, by_v{0, 0, 0};

  // That of a triangle with these edges, along which texture coordinates change by `uv1` and `uv2`.
  // Both are 0 where they do not span the plane.
  [[nodiscard]] static Chart of_triangle(const Vec3& edge1, const Vec3& edge2, const Vec2& uv1,
                                         const Vec2& uv2);
  // That of a tangent along u and the side of v, as Mesh::tangents has them. Its lengths have no
  // meaning, which is enough for normal maps.
  [[nodiscard]] static Chart of_tangent(const Vec3& normal, const Vec3& tangent, float side) {
    return {tangent, cross(normal, tangent) * side};
  }
  // That of a sphere, whose texture coordinates are longitude and latitude, at this unit normal.
  [[nodiscard]] static Chart of_sphere(const Vec3& normal, float radius);
};

class Relief {
 public:
  Relief() = default;  // flat
  // The scene must outlive it.
  Relief(const Material& material, const Scene& scene);

  [[nodiscard]] bool has_heights() const { return heights_ != nullptr; }
  [[nodiscard]] bool flat() const { return normals_ == nullptr && heights_ == nullptr; }
  // The normal that the unit `normal`, seen from the front, becomes. Where the chart is 0 it stays.
  // Normals of a picture are those of the specification of glTF 2.0 with v up; heights turn the
  // normal by their gradient (Blinn 1978, "Simulation of Wrinkled Surfaces").
  [[nodiscard]] Vec3 normal(const Vec3& normal, const Chart& chart, const Vec2& uv) const;

 private:
  [[nodiscard]] Vec3 mapped(const Vec3& normal, const Chart& chart, const Vec2& uv) const;
  [[nodiscard]] Vec3 bumped(const Vec3& normal, const Chart& chart, const Vec2& uv) const;

  const Texture* normals_ = nullptr;
  float scale_ = 1;
  const Texture* heights_ = nullptr;
  float height_ = 0;
};

}  // namespace psf::render
