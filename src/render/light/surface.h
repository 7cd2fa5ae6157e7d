// The point where a ray met a surface, with everything that shading needs.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "render/accel/accel.h"
#include "render/light/relief.h"
#include "render/scene/scene.h"

namespace psf::render {

struct Ray;

struct Surface {
  Vec3 position;
  Vec3 geometric_normal;  // unit, on the side that the ray came from
  Vec3 normal;   // unit shading normal on that side, never facing away from the ray's origin
  Vec2 uv;       // the mesh's, else barycentric; spheres: longitude and latitude, +y up;
                 // curves: u along the segment
  float offset;  // distance from the surface at which rays start, in the unit of the scene's space
  int material;  // index in Scene::materials
  int emitter;   // number of its light; kNone: it emits nothing
  bool front;    // the ray met the front side
  float time = 0;  // that of the ray
  // Area of the triangle where it moves, now over that at the frame.
  float stretch = 1;
  Vec3 rest{0, 0, 0};  // the place of this point at frame 0, as far as the scene keeps it
  bool on_curve = false;
  std::uint32_t primitive = 0;  // of a mesh: the triangle
  int medium = kNone;           // a place in this one of Scene::media instead of a surface

  // The normal as it is shaded for whoever looks along the unit `direction` at this side: where it
  // would face away, it is bent just into sight.
  [[nodiscard]] static Vec3 bent_into_sight(const Vec3& normal, const Vec3& geometric_normal,
                                            const Vec3& direction);

  // A place in a medium, the origin of a ray that came there along its direction.
  [[nodiscard]] static Surface in_medium(const Ray& ray, int medium, int material);

  // The origin of a ray toward `direction`, such that the ray does not meet this surface again.
  [[nodiscard]] Vec3 origin_toward(const Vec3& direction) const {
    return position + geometric_normal * (dot(direction, geometric_normal) > 0 ? offset : -offset);
  }
};

// Rounding moves a point on a surface by some units in the last place of the largest coordinate
// used to compute it. Rays start at kOffsetScale times this coordinate from the surface.
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
  // The scene must outlive this object. No surface emits until set_mesh_emitter() or
  // set_sphere_emitter() is called for it.
  explicit Shapes(const Scene& scene);

  // `direction`: unit direction of the ray; `time`: its time.
  [[nodiscard]] Surface surface(const Hit& hit, const Vec3& direction, float time = 0) const;

  void set_mesh_emitter(std::size_t mesh, int light) { meshes_[mesh].emitter = light; }
  void set_sphere_emitter(std::size_t sphere, int light) { spheres_[sphere].emitter = light; }

 private:
  struct MeshView {
    const Vec3* positions;
    const Vec3* normals;  // null: the mesh has none
    const Vec2* uvs;      // null: the mesh has none
    const std::array<std::uint32_t, 3>* triangles;
    int material, emitter;
    const Mesh* mesh;
    const Relief* relief;  // null: it is flat
  };
  struct SphereView {
    Vec3 center;
    float radius;
    int material, emitter;
    const Sphere* sphere;
    const Relief* relief;
  };
  struct CurvesView {
    const CurvePoint* points;
    const std::uint32_t* segments;
    int material;
  };
  struct InstanceView {
    std::uint32_t prototype;
    float offset;
    Mat4 placement;
    Mat4 normal_placement;  // of normals, up to their length
  };

  // These set all but the sides, which depend on the direction; that is the normal of what has none.
  // They return the relief that turns the normal, and set its chart; null: there is none.
  static const Relief* on_mesh(const MeshView& mesh, const Hit& hit, const Vec3& direction,
                               Surface& s, Chart& chart);
  const Relief* on_instance(const Hit& hit, const Vec3& direction, Surface& s, Chart& chart) const;
  const Relief* on_sphere(const Hit& hit, Surface& s, Chart& chart) const;
  static void on_curve(const CurvesView& curves, const Hit& hit, Surface& s);

  std::vector<Relief> reliefs_;  // by material
  std::vector<MeshView> meshes_, prototypes_;
  std::vector<InstanceView> instances_;
  std::vector<CurvesView> curves_;
  std::vector<SphereView> spheres_;
};

}  // namespace psf::render
