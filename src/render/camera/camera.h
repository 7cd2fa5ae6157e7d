// Camera rays, and the description of a camera for the path-vertex buffer.
#pragma once

#include "formats/layout/metadata.h"
#include "render/light/integrator.h"
#include "render/scene/scene.h"

namespace psf::render {

// A pinhole or thin-lens camera, prepared for rays. In camera space it looks along -z, with +y up
// and +x to the right. The pixel (0, 0) is at the top left, so pixel y grows toward -y.
class CameraRays {
 public:
  // Throws Error{bad_input} naming the camera where it has no view: eye at target, up along the
  // view direction, a field of view outside (0, pi), a size outside [1, 65535], a bad lens.
  explicit CameraRays(const Camera& camera);

  // `pixel`: continuous, x in [0, width), y in [0, height), 0 at the top. `lens`: a point of the
  // unit square, used where the lens has a radius. The direction is unit.
  [[nodiscard]] Ray ray(const Vec2& pixel, const Vec2& lens) const;
  [[nodiscard]] bool has_lens() const { return lens_radius_ > 0; }
  // The description of the camera for the path-vertex buffer, in world units. `space` is the space
  // in which the camera is given. The projection has an infinite far plane. A position projects to
  // clip = projection * camera_to_world^-1 * position, x_pixel = (clip.x / clip.w + 1) / 2 * width,
  // y_pixel = (1 - clip.y / clip.w) / 2 * height.
  [[nodiscard]] formats::CameraInfo info(const Space& space = {}) const;

 private:
  std::string name_;
  std::uint32_t width_, height_;
  Vec3 eye_, right_, up_, back_;  // orthonormal; back_ points from the target to the eye
  float scale_x_, scale_y_;       // half the picture at distance 1
  float lens_radius_, focus_distance_;
};

// Area-preserving map of the unit square to the unit disk (P. Shirley, K. Chiu, "A low distortion
// map between disk and square", 1997).
[[nodiscard]] Vec2 concentric_disk(const Vec2& square);

}  // namespace psf::render
