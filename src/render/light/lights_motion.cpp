// Light sources that move while the shutter is open.
#include "render/light/frame.h"
#include "render/light/lights.h"
#include "render/scene/motion.h"

namespace psf::render {

Lights::Triangle Lights::triangle_at(const Record& light, std::size_t k, float time,
                                     float& stretch) const {
  const auto& [a, b, c] = light.mesh->triangles[k];
  const Vec3 p0 = position_at(*light.mesh, a, time), p1 = position_at(*light.mesh, b, time),
             p2 = position_at(*light.mesh, c, time);
  const Triangle& still = triangles_[light.first + k];
  const TriangleNormal now(p1 - p0, p2 - p0);
  stretch = now.size / TriangleNormal(still.edge1, still.edge2).size;
  const float offset = std::max(max_abs(p0), std::max(max_abs(p1), max_abs(p2))) * kOffsetScale;
  return {p0, p1 - p0, p2 - p0, now.size > 0 ? now.normal : still.normal, offset};
}

Lights::Record Lights::sphere_at(const Record& light, float time) {
  Record moved = light;
  const Ball ball = ball_at(light.sphere->motion, time);
  moved.position = ball.center;
  moved.extent = ball.radius;
  return moved;
}

}  // namespace psf::render
