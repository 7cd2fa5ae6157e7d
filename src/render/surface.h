// What a ray found: the point on the surface with all that shading asks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "render/accel.h"
#include "render/scene.h"

namespace psf::render {

struct Surface {
  Vec3 position;
  Vec3 geometric_normal;  // unit, on the side that the ray came from
  Vec3 normal;   // unit shading normal on that side, never facing away from the ray's origin
  Vec2 uv;       // of the mesh, else barycentric; spheres: longitude and latitude, +y up
  float offset;  // how far rays start from the surface, world units
  int material;  // index in Scene::materials
  int emitter;   // index of its light, kNone for none
  bool front;    // the ray met the front side

  // Where a ray toward `direction` starts, so that it does not meet its own surface again.
  [[nodiscard]] Vec3 origin_toward(const Vec3& direction) const {
    return position + geometric_normal * (dot(direction, geometric_normal) > 0 ? offset : -offset);
  }
};

// Rounding moves a point on a surface by some units in the last place of the largest coordinate
// that took part in computing it; rays start this much times that coordinate away.
constexpr float kOffsetScale = 0x1p-19f;

[[nodiscard]] inline float max_abs(const Vec3& v) {
  return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}

// Longitude and latitude of a unit vector: +y is v = 1, -z is u = 1/2, and u grows toward +x.
[[nodiscard]] Vec2 direction_to_uv(const Vec3& direction);
[[nodiscard]] Vec3 uv_to_direction(const Vec2& uv);

// Turns hits into surfaces.
class Shapes {
 public:
  // The scene must outlive it. Nothing emits until set_..._emitter() says so.
  explicit Shapes(const Scene& scene);

  // `direction`: of the ray that hit, unit.
  [[nodiscard]] Surface surface(const Hit& hit, const Vec3& direction) const;

  void set_mesh_emitter(std::size_t mesh, int light) { meshes_[mesh].emitter = light; }
  void set_sphere_emitter(std::size_t sphere, int light) { spheres_[sphere].emitter = light; }

 private:
  struct MeshView {
    const Vec3* positions;
    const Vec3* normals;  // null for none
    const Vec2* uvs;      // null for none
    const std::array<std::uint32_t, 3>* triangles;
    int material, emitter;
  };
  struct SphereView {
    Vec3 center;
    float radius;
    int material, emitter;
  };

  std::vector<MeshView> meshes_;
  std::vector<SphereView> spheres_;
};

}  // namespace psf::render
