// Checks of a camera, its frame, its rays and its matrices.
#include "render/camera/camera.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "render/scene/motion.h"

namespace psf::render {
namespace {

constexpr double kNear = 1e-2;  // depth only, pixels do not depend on it

[[noreturn]] void fail(const Camera& camera, const std::string& what) {
  throw Error(ErrorCode::bad_input, "camera \"" + camera.name + "\": " + what);
}

void validate(const Camera& camera) {
  if (!is_finite(camera.eye) || !is_finite(camera.target) || !is_finite(camera.up)) {
    fail(camera, "eye, target and up must be finite");
  }
  if (camera.eye == camera.target) fail(camera, "eye and target are the same point, move one");
  if (!(camera.fov > 0 && camera.fov < std::numbers::pi_v<float>)) {
    fail(camera, "the field of view must lie between 0 and 180 degrees");
  }
  if (camera.width == 0 || camera.height == 0 || camera.width > kMaxSide ||
      camera.height > kMaxSide) {
    fail(camera, fmt::format("width and height must lie between 1 and {} pixels", kMaxSide));
  }
  if (!(camera.lens_radius >= 0) || !std::isfinite(camera.lens_radius)) {
    fail(camera, "the radius of the lens must be 0 or more");
  }
  if (camera.lens_radius > 0 && !(camera.focus_distance > 0)) {
    fail(camera, "a lens needs a focus distance above 0");
  }
}

}  // namespace

CameraRays::CameraRays(const Camera& camera)
    : name_(camera.name),
      width_(camera.width),
      height_(camera.height),
      lens_radius_(camera.lens_radius),
      motion_(camera.motion) {
  validate(camera);
  const Vec3 right = cross(camera.up, (camera.eye - camera.target).normalized());
  if (!(length_sq(right) > 1e-10f * length_sq(camera.up))) {
    fail(camera, "up points along the view direction, choose another");
  }
  view_ = view_of(camera.pose());
}

CameraRays::View CameraRays::view_of(const CameraPose& pose) const {
  View view;
  view.eye = pose.eye;
  view.back = (pose.eye - pose.target).normalized();
  view.right = cross(pose.up, view.back);
  view.right.normalize();
  view.up = cross(view.back, view.right);
  view.scale_x = std::tan(pose.fov / 2);
  view.scale_y = view.scale_x * static_cast<float>(height_) / static_cast<float>(width_);
  view.focus_distance = pose.focus_distance;
  return view;
}

Ray CameraRays::ray(const Vec2& pixel, const Vec2& lens, float time) const {
  View view = view_;
  if (!motion_.empty()) {
    const auto [step, share] = step_at(motion_.size(), time);
    view = view_of(mix(motion_[step], motion_[step + 1], share));
  }
  Ray ray = ray_of(view, pixel, lens);
  ray.time = time;
  return ray;
}

Ray CameraRays::ray_of(const View& view, const Vec2& pixel, const Vec2& lens) const {
  const float x = (2 * pixel.x / static_cast<float>(width_) - 1) * view.scale_x;
  const float y = (1 - 2 * pixel.y / static_cast<float>(height_)) * view.scale_y;
  const Vec3 toward = view.right * x + view.up * y - view.back;
  if (!has_lens()) return {view.eye, toward.normalized()};
  const Vec2 disk = concentric_disk(lens) * lens_radius_;
  const Vec3 offset = view.right * disk.x + view.up * disk.y;
  return {view.eye + offset, (toward * view.focus_distance - offset).normalized()};
}

formats::CameraInfo CameraRays::info(const Space& space) const {
  const Imath::V3d eye = space.world(view_.eye);
  formats::CameraInfo info;
  info.name = name_;
  info.width = width_;
  info.height = height_;
  info.angle_per_pixel = 2 * std::atan(double{view_.scale_x} / width_);
  for (int k = 0; k < 3; ++k) {
    const auto row = static_cast<std::size_t>(4 * k);
    info.camera_to_world[row] = double{view_.right[k]};
    info.camera_to_world[row + 1] = double{view_.up[k]};
    info.camera_to_world[row + 2] = double{view_.back[k]};
    info.camera_to_world[row + 3] = eye[k];
  }
  info.camera_to_world[15] = 1;
  info.projection[0] = 1 / double{view_.scale_x};
  info.projection[5] = 1 / double{view_.scale_y};
  info.projection[10] = -1;
  info.projection[11] = -2 * kNear;
  info.projection[14] = -1;
  return info;
}

Vec2 concentric_disk(const Vec2& square) {
  const float a = 2 * square.x - 1;
  const float b = 2 * square.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  constexpr float kQuarter = std::numbers::pi_v<float> / 4;
  const bool wide = std::abs(a) > std::abs(b);
  const float radius = wide ? a : b;
  const float angle = wide ? kQuarter * (b / a) : 2 * kQuarter - kQuarter * (a / b);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace psf::render
