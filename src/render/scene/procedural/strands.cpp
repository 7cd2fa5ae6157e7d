// Strands: smooth curves through points, and a ball of hair.
#include <algorithm>

#include "render/scene/procedural/noise.h"
#include "render/scene/procedural/procedural.h"
#include "render/scene/procedural/random.h"

namespace psf::render {

Strand smooth(const Strand& points, std::uint32_t pieces) {
  if (points.size() < 3 || pieces < 2) return points;
  Strand curve;
  const auto at = [&](std::size_t i) { return points[std::min(i, points.size() - 1)]; };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const StrandPoint before = at(i == 0 ? 0 : i - 1), from = at(i), to = at(i + 1),
                      after = at(i + 2);
    for (std::uint32_t k = 0; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces, s = 1 - t;
      // Cubic of Hermite with the slopes (to - before) / 2 and (after - from) / 2.
      const double a = s * s * (1 + 2 * t), b = t * t * (3 - 2 * t), c = t * s * s / 2,
                   d = t * t * s / 2;
      const auto mixed = [&](const auto& p0, const auto& p1, const auto& p2, const auto& p3) {
        return p1 * a + p2 * b + (p2 - p0) * c - (p3 - p1) * d;
      };
      const double radius = mixed(before.radius, from.radius, to.radius, after.radius);
      curve.push_back({mixed(before.position, from.position, to.position, after.position),
                       std::max(radius, 0.0)});
    }
  }
  curve.push_back(points.back());
  return curve;
}

std::vector<Strand> make_hairball(const Hairball& hairball) {
  Random random(hairball.seed);
  const Noise locks(hairball.seed);
  std::vector<Strand> strands(hairball.strands);
  const double core = 0.45, step = (1 - core) / hairball.segments;
  for (Strand& strand : strands) {
    const Imath::V3d root = random.on_sphere();
    const Imath::V3d own = random.on_sphere() * 0.35;
    const double length = random.between(0.75, 1.0);
    Imath::V3d p = root * core, heading = root;
    for (std::uint32_t k = 0; k <= hairball.segments; ++k) {
      const double t = static_cast<double>(k) / hairball.segments;
      strand.push_back({p * hairball.radius, hairball.thickness / 2 * (1 - t * t * 0.98)});
      // Neighbours bend alike, as locks do; each strand a little as it likes.
      const Imath::V3d bend = locks.vector(p * 3.5) * 3.0 + locks.vector(p * 9 + own) * 1.2 + own;
      const Imath::V3d aim = root * 0.9 + bend * hairball.curl;
      heading = (heading * 0.6 + aim * 0.4).normalized();
      // Strands bend back before they leave the ball.
      const double out = p.length();
      if (out > 0.97 && p.dot(heading) > 0)
        heading = (heading - p * (p.dot(heading) / (out * out))).normalized();
      p += heading * (step * length * 1.25);
    }
  }
  return strands;
}

}  // namespace psf::render
