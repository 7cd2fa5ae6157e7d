// Camera rays, and the description of a camera for the path-vertex buffer.
#pragma once

#include "formats/layout/metadata.h"
#include "render/light/integrator.h"
#include "render/scene/scene.h"

namespace psf::render {

// A pinhole or thin-lens camera, prepared for rays. It is described as it is at the frame, whatever
// it does while the shutter is open. In camera space it looks along -z, with +y up
// and +x to the right. The pixel (0, 0) is at the top left, so pixel y grows toward -y.
class CameraRays {
 public:
  // Throws Error{bad_input} naming the camera where it has no view: eye at target, up along the
  // view direction, a field of view outside (0, pi), a size outside [1, 65535], a bad lens.
  explicit CameraRays(const Camera& camera);

  // `pixel`: continuous, x in [0, width), y in [0, height), 0 at the top. `lens`: a point of the
  // unit square, used where the lens has a radius. `time`: of Scene::shutter, where the camera
  // moves. The direction is unit.
  [[nodiscard]] Ray ray(const Vec2& pixel, const Vec2& lens, float time = 0) const;
  [[nodiscard]] bool has_lens() const { return lens_radius_ > 0; }
  // The description of the camera for the path-vertex buffer, in world units. `space` is the space
  // in which the camera is given. The projection has an infinite far plane. A position projects to
  // clip = projection * camera_to_world^-1 * position, x_pixel = (clip.x / clip.w + 1) / 2 * width,
  // y_pixel = (1 - clip.y / clip.w) / 2 * height.
  [[nodiscard]] formats::CameraInfo info(const Space& space = {}) const;

 private:
  // Where a camera looks.
  struct View {
    Vec3 eye, right, up, back;  // orthonormal; back points from the target to the eye
    float scale_x, scale_y;     // half the picture at distance 1
    float focus_distance;
  };
  [[nodiscard]] View view_of(const CameraPose& pose) const;
  [[nodiscard]] Ray ray_of(const View& view, const Vec2& pixel, const Vec2& lens) const;

  std::string name_;
  std::uint32_t width_, height_;
  float lens_radius_;
  View view_;
  std::vector<CameraPose> motion_;
};

// Area-preserving map of the unit square to the unit disk (P. Shirley, K. Chiu, "A low distortion
// map between disk and square", 1997).
[[nodiscard]] Vec2 concentric_disk(const Vec2& square);

}  // namespace psf::render
