// Ray queries by Embree: building its scene from ours.
#include "render/accel/accel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/error.h"

namespace psf::render {

namespace {

const char* describe(RTCError error) {
  switch (error) {
    case RTC_ERROR_OUT_OF_MEMORY:
      return "out of memory; use a smaller scene";
    case RTC_ERROR_UNSUPPORTED_CPU:
      return "this processor lacks SSE2";
    case RTC_ERROR_INVALID_ARGUMENT:
      return "invalid argument";
    case RTC_ERROR_INVALID_OPERATION:
      return "invalid operation";
    case RTC_ERROR_CANCELLED:
      return "cancelled";
    default:
      return "unknown error";
  }
}

}  // namespace

Accel::Accel(const Scene& scene) : device_(rtcNewDevice(nullptr)) {
  check_embree(device_.get(), "no device");
  scene_ = new_scene();
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    add_mesh(scene_.get(), scene.meshes[m], static_cast<unsigned>(m));
  }
  add_spheres(scene.spheres, static_cast<unsigned>(scene.meshes.size()));
  first_instance_ = static_cast<unsigned>(scene.meshes.size()) + 1;
  for (const Curves& curves : scene.curves) add_curves(curves, first_instance_++);
  add_instances(scene);
  rtcCommitScene(scene_.get());
  check_embree(device_.get(), "build");

  RTCBounds bounds;
  rtcGetSceneBounds(scene_.get(), &bounds);
  const Vec3 lower(bounds.lower_x, bounds.lower_y, bounds.lower_z);
  const Vec3 upper(bounds.upper_x, bounds.upper_y, bounds.upper_z);
  if (lower.x <= upper.x) {
    center_ = (lower + upper) * 0.5f;
    radius_ = std::sqrt(length_sq(upper - lower)) * 0.5f;
  }
}

void Accel::add_curves(const Curves& curves, unsigned id) {
  if (curves.segments.empty()) return;
  static_assert(sizeof(CurvePoint) == 16);
  const EmbreeGeometry geometry(
      rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE));
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                             curves.points.data(), 0, sizeof(CurvePoint), curves.points.size());
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                             curves.segments.data(), 0, sizeof(curves.segments[0]),
                             curves.segments.size());
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(scene_.get(), geometry.get(), id);
  check_embree(device_.get(), fmt::format("curves '{}'", curves.name));
}

EmbreeScene Accel::new_scene() const {
  EmbreeScene scene(rtcNewScene(device_.get()));
  check_embree(device_.get(), "no scene");
  // Robust: no ray passes between two triangles that share an edge.
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  return scene;
}

void Accel::add_instances(const Scene& scene) {
  // Each scene of a prototype lives on in the instances that show it.
  std::vector<EmbreeScene> shown;
  for (const Mesh& prototype : scene.prototypes) {
    shown.push_back(new_scene());
    add_mesh(shown.back().get(), prototype, 0);
    rtcCommitScene(shown.back().get());
    check_embree(device_.get(), fmt::format("mesh '{}'", prototype.name));
  }
  unsigned id = first_instance_;
  for (const Instance& instance : scene.instances) {
    const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(geometry.get(), shown[instance.prototype].get());
    std::array<float, 12> placement;
    for (std::size_t k = 0; k < placement.size(); ++k) {
      placement[k] = instance.placement[static_cast<int>(k / 3)][static_cast<int>(k % 3)];
    }
    rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, placement.data());
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene_.get(), geometry.get(), id++);
  }
  check_embree(device_.get(), "instances");
}

void Accel::add_mesh(RTCScene target, const Mesh& mesh, unsigned id) {
  if (mesh.triangles.empty()) return;
  const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  const std::size_t count = mesh.positions.size();
  // Embree reads 16 bytes at each 12-byte position, so the last one needs room behind it.
  if (!mesh.motion.empty()) {
    rtcSetGeometryTimeStepCount(geometry.get(), static_cast<unsigned>(mesh.motion.size()));
    for (unsigned step = 0; step < mesh.motion.size(); ++step) {
      auto* copy = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
          geometry.get(), RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, sizeof(Vec3), count));
      if (copy != nullptr) std::ranges::copy(mesh.motion[step].positions, copy);
    }
  } else if (mesh.positions.capacity() > count) {
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.positions.data(), 0, sizeof(Vec3), count);
  } else {
    auto* copy = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), count));
    if (copy != nullptr) std::ranges::copy(mesh.positions, copy);
  }
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             mesh.triangles.data(), 0, sizeof(mesh.triangles[0]),
                             mesh.triangles.size());
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(target, geometry.get(), id);
  check_embree(device_.get(), fmt::format("mesh '{}'", mesh.name));
}

void Accel::add_spheres(const std::vector<Sphere>& spheres, unsigned id) {
  if (spheres.empty()) return;
  // Spheres are one geometry: where one moves, all have its number of steps.
  std::size_t steps = 1;
  for (const Sphere& s : spheres) steps = std::max(steps, s.motion.size());
  points_.reserve(spheres.size() * steps);
  for (std::size_t step = 0; step < steps; ++step) {
    for (const Sphere& s : spheres) {
      const Ball ball = s.motion.empty() ? Ball{s.center, s.radius} : s.motion[step];
      points_.push_back({ball.center.x, ball.center.y, ball.center.z, ball.radius});
    }
  }
  const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT));
  rtcSetGeometryTimeStepCount(geometry.get(), static_cast<unsigned>(steps));
  for (std::size_t step = 0; step < steps; ++step) {
    rtcSetSharedGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(step), RTC_FORMAT_FLOAT4,
        points_.data(), step * spheres.size() * sizeof(Point), sizeof(Point), spheres.size());
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(scene_.get(), geometry.get(), id);
  check_embree(device_.get(), "spheres");
}

void check_embree(RTCDevice device, const std::string& what) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw Error(ErrorCode::limit, fmt::format("Embree: {}: {}", what, describe(error)));
}

}  // namespace psf::render
