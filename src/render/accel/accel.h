// Ray queries against the surfaces of a scene, answered by Embree.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/vec.h"
#include "render/accel/embree.h"
#include "render/scene/scene.h"

namespace psf::render {

// For `geometry` < meshes.size(), mesh number `geometry` was hit: `primitive` is the triangle, u
// and v are the barycentric weights of its second and third corner. For `geometry` == meshes.size()
// a sphere was hit, and `primitive` is its number; above, curves number `geometry` - meshes.size()
// - 1, of which `primitive` is the segment. Where `instance` is the number of one, the triangle is
// one of its prototype, and `normal` is not in the scene's space.
struct Hit {
  static constexpr std::uint32_t kNoInstance = RTC_INVALID_GEOMETRY_ID;
  float distance = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;
  std::uint32_t geometry = RTC_INVALID_GEOMETRY_ID, primitive = 0;
  Vec3 normal{0, 0, 0};  // Embree's geometric normal, not of unit length
  std::uint32_t instance = kNoInstance;
  Vec3 place{0, 0, 0};  // on the ray, with errors that grow with the distance
};

// A query as it was asked, for who asks it again to measure.
struct RecordedRay {
  Vec3 origin;
  float beyond;
  Vec3 direction;
  float reach;
  float time;
  bool occlusion;  // whether anything is in the way, not what
  bool met;
};

class Accel {
 public:
  // Uses the buffers of the scene, which must outlive this object. Throws Error{limit} where Embree
  // reports an error.
  explicit Accel(const Scene& scene);

  // Finds the nearest hit at a distance in (beyond, reach]; returns false where there is none.
  // `direction` is a unit vector; `time` in [0, 1] is of Scene::shutter.
  [[nodiscard]] bool intersect(const Vec3& origin, const Vec3& direction, Hit& hit,
                               float reach = std::numeric_limits<float>::infinity(), float time = 0,
                               float beyond = 0) const {
    RTCRayHit query;
    set_ray(query.ray, origin, direction, reach, time);
    query.ray.tnear = beyond;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect(scene_.get(), query);
    const bool met = query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    if (log_ != nullptr) log({origin, beyond, direction, reach, time, false, met});
    if (!met) return false;
    hit = {query.ray.tfar,   query.hit.u,      query.hit.v,
           query.hit.geomID, query.hit.primID, {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}};
    hit.place = origin + direction * hit.distance;
    if (query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID)
      hit.instance = query.hit.instID[0] - first_instance_;
    return true;
  }

  // Whether any surface lies at origin + t * direction for t in (0, reach]. `direction` may have
  // any length.
  [[nodiscard]] bool occluded(const Vec3& origin, const Vec3& direction, float reach,
                              float time = 0) const {
    RTCRay ray;
    set_ray(ray, origin, direction, reach, time);
    embree_occluded(scene_.get(), ray);
    const bool met = ray.tfar < 0;
    if (log_ != nullptr) log({origin, 0, direction, reach, time, true, met});
    return met;
  }

  // From now on adds every query to `rays`, as long as its capacity lasts; null: to none. While it
  // does, one thread alone may ask.
  void record(std::vector<RecordedRay>* rays) const { log_ = rays; }
  [[nodiscard]] RTCScene embree() const { return scene_.get(); }

  // A sphere around all surfaces; radius 1 for a scene without any.
  [[nodiscard]] const Vec3& center() const { return center_; }
  [[nodiscard]] float radius() const { return radius_; }

 private:
  void log(const RecordedRay& ray) const {
    if (log_->size() < log_->capacity()) log_->push_back(ray);
  }
  static void set_ray(RTCRay& ray, const Vec3& origin, const Vec3& direction, float reach,
                      float time) {
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.tnear = 0;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.time = time;
    ray.tfar = reach;
    ray.mask = ~0u;
    ray.id = 0;
    ray.flags = 0;
  }

  struct alignas(16) Point {
    float x, y, z, radius;
  };

  // To `target`, under the number `id`.
  void add_mesh(RTCScene target, const Mesh& mesh, unsigned id);
  void add_spheres(const std::vector<Sphere>& spheres, unsigned id);
  void add_curves(const Curves& curves, unsigned id);
  void add_instances(const Scene& scene);
  [[nodiscard]] EmbreeScene new_scene() const;

  EmbreeDevice device_;
  EmbreeScene scene_;
  mutable std::vector<RecordedRay>* log_ = nullptr;
  unsigned first_instance_ = 0;  // Embree's number of instance 0
  std::vector<Point> points_;
  Vec3 center_{0, 0, 0};
  float radius_ = 1;
};

}  // namespace psf::render
