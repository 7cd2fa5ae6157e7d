#include "render/light/stand.h"

#include <algorithm>
#include <cmath>

#include "render/light/frame.h"
#include "render/light/opacity.h"
#include "render/scene/copies.h"
#include "render/scene/motion.h"

namespace psf::render {
namespace {

// Five of them, no two nearly alike, and none along an axis or a diagonal.
const Vec3 kDirections[] = {Vec3(0.3713f, 0.8147f, 0.4459f), Vec3(-0.8571f, 0.2293f, 0.4613f),
                            Vec3(0.1217f, -0.5479f, 0.8277f), Vec3(0.6983f, -0.3511f, -0.6237f),
                            Vec3(-0.4337f, 0.1873f, -0.8814f)};

Imath::Box3f box_of(const Mesh& mesh) {
  Imath::Box3f box;
  for (const Vec3& p : mesh.positions) box.extendBy(p);
  for (const MeshStep& step : mesh.motion) {
    for (const Vec3& p : step.positions) box.extendBy(p);
  }
  return box;
}

Imath::Box3f box_of(const Sphere& sphere) {
  Imath::Box3f box;
  const auto add = [&](const Vec3& center, float radius) {
    box.extendBy(center - Vec3(radius));
    box.extendBy(center + Vec3(radius));
  };
  add(sphere.center, sphere.radius);
  for (const Ball& ball : sphere.motion) add(ball.center, ball.radius);
  return box;
}

}  // namespace

Stands::Stands(const Scene& scene, const Accel& accel, const Shapes& shapes, bool in_volumes)
    : scene_(scene), accel_(accel), shapes_(shapes), in_volumes_(in_volumes) {
  std::map<int, Imath::Box3f> boxes;
  const auto add = [&](int material, const auto& box_of_shape) {
    if (is_boundary(material)) boxes[material].extendBy(box_of_shape());
  };
  for (const Mesh& m : scene.meshes) add(m.material, [&] { return box_of(m); });
  for (const Sphere& s : scene.spheres) add(s.material, [&] { return box_of(s); });
  for (const Instance& i : scene.instances) {
    const Mesh& mesh = scene.prototypes[i.prototype];
    add(mesh.material, [&] {
      const Imath::Box3d box = bounds_of(bounds_of(mesh), i);
      return Imath::Box3f(Vec3(box.min), Vec3(box.max));
    });
  }
  for (const auto& [material, box] : boxes) boxes_.push_back(box);
  if (shapes_move(scene)) return;
  for (const Camera& camera : scene.cameras) {
    const Vec3& eye = camera.eye;
    std::uint64_t unused = 0;
    if (camera.motion.empty() && camera.lens_radius == 0 && may_be_inside(eye))
      known_[{eye.x, eye.y, eye.z}] = found(eye, 0, unused);
  }
}

bool Stands::is_boundary(int material) const {
  const MaterialKind kind = scene_.materials[static_cast<std::size_t>(material)].kind;
  return kind == MaterialKind::subsurface || kind == MaterialKind::volume ||
         (kind == MaterialKind::glass && in_volumes_);
}

bool Stands::may_be_inside(const Vec3& place) const {
  return std::any_of(boxes_.begin(), boxes_.end(),
                     [&](const Imath::Box3f& box) { return box.intersects(place); });
}

Stand Stands::at(const Vec3& place, float time, std::uint64_t& rays) const {
  if (!may_be_inside(place)) return {Media(scene_.medium)};
  const auto known = known_.find({place.x, place.y, place.z});
  return known != known_.end() ? known->second : found(place, time, rays);
}

Stand Stands::found(const Vec3& place, float time, std::uint64_t& rays) const {
  std::vector<Around> looks;
  for (const Vec3& direction : kDirections) looks.push_back(look(place, direction, time, rays));
  // Panes of glass are seldom closed: glass is around a place where it is on all sides.
  const auto is_glass = [&](int material) {
    return scene_.materials[static_cast<std::size_t>(material)].kind == MaterialKind::glass;
  };
  const bool in_glass = std::ranges::all_of(
      looks, [&](const Around& around) { return std::ranges::any_of(around, is_glass); });
  if (!in_glass) {
    for (Around& around : looks) std::erase_if(around, is_glass);
  }
  const auto alike = [&](const Around& around) { return std::ranges::count(looks, around); };
  return stand_in(*std::ranges::max_element(looks, {}, alike));
}

Stands::Around Stands::look(const Vec3& place, const Vec3& direction, float time,
                            std::uint64_t& rays) const {
  // By material, so that what is not closed spoils no other.
  struct Passed {
    int open = 0;  // surfaces that the ray is in and that are not around the place
    float last = -1;
    bool last_front = false;
  };
  std::map<int, Passed> passed;
  Around around;
  const Vec3 along = normalize(direction);
  Hit hit;
  float beyond = 0;
  for (;; beyond = std::nextafter(hit.distance, RayCaster::kEndless)) {
    ++rays;
    if (!accel_.intersect(place, along, hit, RayCaster::kEndless, time, beyond)) return around;
    const Surface surface = shapes_.surface(hit, along, time);
    if (surface.on_curve || !is_boundary(surface.material)) continue;
    Passed& own = passed[surface.material];
    // At an edge both its triangles may be met.
    const bool again = own.last >= 0 && own.last_front == surface.front &&
                       hit.distance - own.last <= surface.offset;
    own.last = hit.distance;
    own.last_front = surface.front;
    if (again) continue;
    if (surface.front) {
      ++own.open;
    } else if (own.open > 0) {
      --own.open;
    } else {
      around.push_back(surface.material);
    }
  }
}

Stand Stands::stand_in(const Around& around) const {
  const auto of = [&](int material) -> const Material& {
    return scene_.materials[static_cast<std::size_t>(material)];
  };
  Stand stand{Media(scene_.medium)};
  for (std::size_t k = around.size(); k-- > 0;) {
    const Material& material = of(around[k]);
    if (material.kind == MaterialKind::volume) stand.media.enter(material.interior);
    if (material.kind == MaterialKind::glass) stand.media.enter(kNone);
  }
  if (around.empty() || of(around[0]).kind != MaterialKind::subsurface) return stand;
  stand.body = around[0];
  const int interior = of(stand.body).interior;
  for (const int material : around) {
    if (of(material).kind == MaterialKind::subsurface && of(material).interior == interior)
      ++stand.bodies;
  }
  return stand;
}

}  // namespace psf::render
