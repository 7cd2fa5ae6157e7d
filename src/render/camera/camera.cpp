// Checks of a camera, its frame, its rays and its matrices.
#include "render/camera/camera.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.h"

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
      eye_(camera.eye),
      lens_radius_(camera.lens_radius),
      focus_distance_(camera.focus_distance) {
  validate(camera);
  back_ = (camera.eye - camera.target).normalized();
  right_ = cross(camera.up, back_);
  if (!(length_sq(right_) > 1e-10f * length_sq(camera.up))) {
    fail(camera, "up points along the view direction, choose another");
  }
  right_.normalize();
  up_ = cross(back_, right_);
  scale_x_ = std::tan(camera.fov / 2);
  scale_y_ = scale_x_ * static_cast<float>(height_) / static_cast<float>(width_);
}

Ray CameraRays::ray(const Vec2& pixel, const Vec2& lens) const {
  const float x = (2 * pixel.x / static_cast<float>(width_) - 1) * scale_x_;
  const float y = (1 - 2 * pixel.y / static_cast<float>(height_)) * scale_y_;
  const Vec3 toward = right_ * x + up_ * y - back_;
  if (!has_lens()) return {eye_, toward.normalized()};
  const Vec2 disk = concentric_disk(lens) * lens_radius_;
  const Vec3 offset = right_ * disk.x + up_ * disk.y;
  return {eye_ + offset, (toward * focus_distance_ - offset).normalized()};
}

formats::CameraInfo CameraRays::info(const Space& space) const {
  const Imath::V3d eye = space.world(eye_);
  formats::CameraInfo info;
  info.name = name_;
  info.width = width_;
  info.height = height_;
  info.angle_per_pixel = 2 * std::atan(double{scale_x_} / width_);
  for (int k = 0; k < 3; ++k) {
    const auto row = static_cast<std::size_t>(4 * k);
    info.camera_to_world[row] = double{right_[k]};
    info.camera_to_world[row + 1] = double{up_[k]};
    info.camera_to_world[row + 2] = double{back_[k]};
    info.camera_to_world[row + 3] = eye[k];
  }
  info.camera_to_world[15] = 1;
  info.projection[0] = 1 / double{scale_x_};
  info.projection[5] = 1 / double{scale_y_};
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
