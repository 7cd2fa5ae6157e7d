// Where along a ray a light without extent is met in a medium: distances by the angle at the light.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/light/integrator.h"
#include "render/scene/scene.h"

namespace psf::render {

// The part of a ray that a point or spot light can shine on, and distances on it that are even in the
// angle at the light, as what it sends there falls with the square of how far away it is (C. Kulla
// and M. Fajardo 2012, "Importance Sampling Techniques for Path Tracing in Participating Media").
class LitStretch {
 public:
  LitStretch(const Light& light, const Ray& ray, float reach) : to_(double{reach}) {
    if (light.kind == LightKind::directional) {
      to_ = -1;
      return;
    }
    const Imath::V3d from_light = Imath::V3d(ray.origin) - Imath::V3d(light.position);
    const Imath::V3d direction(ray.direction);
    if (light.kind == LightKind::spot) clip(light, from_light, direction);
    foot_ = -from_light.dot(direction);
    const double origin_sq = from_light.dot(from_light);
    // Any width is right; where the ray goes through the light it must be some.
    width_ = std::sqrt(std::max(origin_sq - foot_ * foot_, 1e-6 * origin_sq));
    first_ = angle(from_);
    last_ = angle(to_);
  }

  [[nodiscard]] bool empty() const { return !(from_ < to_ && first_ < last_ && width_ > 0); }
  // These are for a stretch that is not empty.
  [[nodiscard]] float sample(float u) const {
    const double at = foot_ + width_ * std::tan(first_ + double{u} * (last_ - first_));
    return static_cast<float>(std::clamp(at, from_, to_));
  }
  [[nodiscard]] float density(float distance) const {
    const double at{distance}, beside = at - foot_;
    if (at < from_ || at > to_) return 0;
    return static_cast<float>(width_ / ((last_ - first_) * (width_ * width_ + beside * beside)));
  }

 private:
  [[nodiscard]] double angle(double distance) const { return std::atan2(distance - foot_, width_); }

  // Keeps what is in the cone of a spot light; all of it where rounding would decide.
  void clip(const Light& light, const Imath::V3d& from_light, const Imath::V3d& direction) {
    const Imath::V3d axis(light.direction);
    const double m = double{light.cos_outer} * double{light.cos_outer};
    const double da = direction.dot(axis), oa = from_light.dot(axis);
    // At a distance t the place is in the cone, or in its mirror image, where
    // a t^2 + 2 b t + c >= 0.
    const double a = da * da - m, b = oa * da - m * from_light.dot(direction),
                 c = oa * oa - m * from_light.dot(from_light);
    if (std::abs(a) < 1e-9) return;
    const double root_sq = b * b - a * c;
    if (root_sq < 0) {
      to_ = -1;
      return;
    }
    const double root = std::sqrt(root_sq) / std::abs(a);
    const double near = -b / a - root, far = -b / a + root;
    if (a > 0 && da > 0) {
      from_ = std::max(from_, far);
    } else if (a > 0) {
      to_ = std::min(to_, near);
    } else {
      from_ = std::max(from_, near);
      to_ = oa + da * (near + far) / 2 > 0 ? std::min(to_, far) : -1;
    }
  }

  double from_ = 0, to_, foot_ = 0, width_ = 0, first_ = 0, last_ = 0;
};

}  // namespace psf::render
