// A tuft of grass, and places of many.
#include <cmath>

#include "render/scene/procedural/procedural.h"
#include "render/scene/procedural/random.h"
#include "render/scene/shapes.h"

namespace psf::render {

Mesh make_tuft(const Tuft& tuft) {
  constexpr int kBladePieces = 5;
  Random random(tuft.seed);
  Mesh mesh;
  for (std::uint32_t blade = 0; blade < tuft.blades; ++blade) {
    const Imath::V2d root = random.in_disk(), sideways = random.on_circle();
    const Imath::V2d out = (root + sideways * 0.4).normalized();
    const double height = tuft.height * random.between(0.55, 1.0);
    const double bend = tuft.bend * random.between(0.3, 1.0) * height;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k <= kBladePieces; ++k) {
      const double t = static_cast<double>(k) / kBladePieces;
      const double lean = bend * t * t, rise = height * t - 0.4 * bend * t * t;
      const Imath::V3d middle(root.x * tuft.spread + out.x * lean, rise,
                              root.y * tuft.spread + out.y * lean);
      const double half = tuft.width / 2 * (1 - t * t);
      const Imath::V3d side(-out.y * half, 0, out.x * half);
      for (const double sign : {-1.0, 1.0}) {
        if (k == kBladePieces && sign > 0) continue;  // the tip is one point
        mesh.positions.push_back(Vec3(middle + side * sign));
        mesh.uvs.emplace_back(sign < 0 ? 0.0f : 1.0f, static_cast<float>(t));
      }
    }
    for (std::uint32_t k = 0; k < kBladePieces; ++k) {
      const std::uint32_t a = first + 2 * k;
      mesh.triangles.push_back({a, a + 1, a + 2});
      if (k + 1 < kBladePieces) mesh.triangles.push_back({a + 2, a + 1, a + 3});
    }
  }
  mesh.normals = smooth_normals(mesh);
  return mesh;
}

std::vector<Imath::M44d> scatter(const Scatter& how) {
  Random random(how.seed);
  const double start_y = random.unit();
  const Imath::V2d start(random.unit(), start_y);
  constexpr double kStepX = 0.7548776662466927, kStepZ = 0.5698402909980532;
  std::vector<Imath::M44d> places;
  places.reserve(how.count);
  for (std::uint32_t k = 0; k < how.count; ++k) {
    const double x = start.x + kStepX * k, z = start.y + kStepZ * k;
    const Imath::V2d turn = random.on_circle();
    const double size = random.between(how.least, how.most);
    const double c = turn.x * size, s = turn.y * size;
    places.emplace_back(c, 0, -s, 0, 0, size, 0, 0, s, 0, c, 0,
                        (x - std::floor(x) - 0.5) * how.width, 0,
                        (z - std::floor(z) - 0.5) * how.depth, 1);
  }
  return places;
}

}  // namespace psf::render
