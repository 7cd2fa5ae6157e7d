// Shapes that are grown from a seed: their forms, their bounds, and the same one every time.
#include "render/scene/procedural/procedural.h"

#include <ImathBox.h>

#include <algorithm>
#include <array>
#include <map>

#include "catch.h"
#include "load_support.h"

namespace psf::render {
namespace {

Scene grown(const std::string& keys) {
  const TempFolder folder;
  return load_scene(folder.write("s.json", with_shapes(R"({"material": "white", )" + keys + "}")));
}

TEST_CASE("A noise sphere is closed and faces outward, however deep its folds", "[procedural]") {
  NoiseSphere sphere;
  sphere.amplitude = GENERATE(0.0, 0.5);
  sphere.segments = 9;
  const Mesh mesh = make_noise_sphere(sphere);
  CHECK(mesh.triangles.size() == 12 * 81);
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> edges;  // each once in each direction
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &p = mesh.positions[t[k]], &q = mesh.positions[t[(k + 1) % 3]];
      ++edges[{{p.x, p.y, p.z}, {q.x, q.y, q.z}}];
    }
    const Imath::V3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    volume += a.dot(b.cross(c)) / 6;
    CHECK(dot(mesh.normals[t[0]], Vec3((b - a).cross(c - a))) > 0);
  }
  for (const auto& [edge, count] : edges) {
    CHECK(count == 1);
    CHECK(edges.count({edge.second, edge.first}) == 1);
  }
  if (sphere.amplitude == 0) {
    CHECK(volume == Approx(4.18879).epsilon(0.03));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      CHECK(length_sq(mesh.positions[i]) == Approx(1));
      CHECK(dot(mesh.positions[i], mesh.normals[i]) == Approx(1).epsilon(1e-3));
    }
  } else {
    CHECK(volume > 1);
  }
}

TEST_CASE("Hair grows from a core and stays in its ball", "[procedural]") {
  Hairball hair;
  hair.seed = 5;
  hair.strands = 300;
  hair.radius = 2;
  const auto strands = make_hairball(hair);
  REQUIRE(strands.size() == 300);
  Imath::V3d sum(0);
  for (const Strand& strand : strands) {
    REQUIRE(strand.size() == hair.segments + 1);
    CHECK(strand[0].position.length() == Approx(0.9));
    CHECK(strand[0].radius == Approx(hair.thickness / 2));
    for (const StrandPoint& p : strand) CHECK(p.position.length() < 2.1);
    CHECK(strand.back().radius < strand[0].radius / 10);
    sum += strand[0].position;
  }
  CHECK(sum.length() / 300 < 0.15);  // from all sides
}

TEST_CASE("A smooth strand passes through its points, and stays straight where they are",
          "[procedural]") {
  const Strand bent = {{{0, 0, 0}, 1}, {{1, 2, 0}, 2}, {{3, 2, 1}, 1}, {{3, 0, 0}, 0}};
  const Strand fine = smooth(bent, 5);
  REQUIRE(fine.size() == 16);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK((fine[5 * k].position - bent[k].position).length() < 1e-12);
    CHECK(fine[5 * k].radius == Approx(bent[k].radius));
  }
  const Strand straight = {{{0, 0, 0}, 1}, {{1, 1, 1}, 1}, {{2, 2, 2}, 1}};
  for (const StrandPoint& p : smooth(straight, 7)) {
    CHECK(p.position.x == Approx(p.position.y));
    CHECK(p.radius == Approx(1));
  }
}

TEST_CASE("A tree has its leaves on its twigs", "[procedural]") {
  Tree tree;
  tree.seed = 2;
  tree.leaves = 700;
  const TreeParts parts = make_tree(tree);
  CHECK(parts.leaves.size() == 700);
  CHECK(parts.leaf.triangles.size() == 28);
  Imath::Box3d wood;
  for (const Vec3& p : parts.wood.positions) wood.extendBy(Imath::V3d(p));
  CHECK(wood.max.y > 0.7 * tree.height);
  CHECK(wood.max.y < 1.4 * tree.height);
  for (const auto& leaf : parts.leaves) {
    const Imath::V3d place = leaf.translation();
    CHECK(wood.intersects(place));
    CHECK(place.y > 0.15 * tree.height);
    CHECK(leaf.determinant() > 0);
    double nearest = 1e300;
    for (const Vec3& p : parts.wood.positions)
      nearest = std::min(nearest, (Imath::V3d(p) - place).length());
    CHECK(nearest < 0.25);
  }
}

TEST_CASE("Blades of a tuft stand in their disk and are as high as they may be", "[procedural]") {
  Tuft tuft;
  tuft.blades = 100;
  tuft.height = 2;
  tuft.spread = 0.5;
  const Mesh mesh = make_tuft(tuft);
  CHECK(mesh.triangles.size() == 900);
  float top = 0;
  for (const Vec3& p : mesh.positions) {
    CHECK(p.y >= 0);
    CHECK(p.y <= 2);
    if (p.y == 0) CHECK(std::hypot(p.x, p.z) <= 0.55f);
    top = std::max(top, p.y);
  }
  CHECK(top > 1.5f);
}

TEST_CASE("Scattered copies are spread evenly over their area", "[procedural]") {
  Scatter how;
  how.count = 1000;
  how.width = 8;
  how.depth = 4;
  how.least = 0.5;
  how.most = 2;
  std::array<int, 16> cells{};
  for (const Imath::M44d& m : scatter(how)) {
    const Imath::V3d p = m.translation();
    REQUIRE((std::abs(p.x) <= 4 && p.y == 0 && std::abs(p.z) <= 2));
    ++cells[static_cast<std::size_t>((p.x + 4) / 2) * 4 + static_cast<std::size_t>(p.z + 2)];
    const double size = std::cbrt(m.determinant());
    CHECK(size >= 0.5);
    CHECK(size <= 2);
  }
  for (const int count : cells) CHECK(std::abs(count - 62.5) < 8);
  const Scene scene = grown(R"("shape": "tuft", "blades": 3,
      "scatter": {"count": 7, "area": [10, 10], "scale": [1, 2]})");
  CHECK(scene.meshes.at(0).triangles.size() == 7 * 27);
}

TEST_CASE("The same seed grows the same shape everywhere, another one another", "[procedural]") {
  const std::vector<std::pair<std::string, std::string>> known = {
      {R"("shape": "hairball", "strands": 50)", "e5d95c5015dcfc1820d593b4f442066b"},
      {R"("shape": "noise-sphere", "segments": 12)", "b97dd45c59963a26dc442d247480fb9d"},
      {R"("shape": "tuft")", "6d1553835d7f2453011000ab8d0ebd6c"},
      {R"("shape": "tree", "leaf_material": "white", "leaves": 100)",
       "38765c5e27faca9dbfa7e79b57a02871"},
      {R"("shape": "quad", "origin": [0, 0, 0], "u": [1, 0, 0], "v": [0, 1, 0],
          "scatter": {"count": 9, "area": [3, 4]})",
       "555c7385e7616236104e3c6b87939cb6"}};
  for (const auto& [keys, hash] : known) {
    CAPTURE(keys);
    CHECK(grown(keys).hash == hash);
    if (!contains(keys, "scatter")) CHECK(grown(keys + R"(, "seed": 1)").hash != hash);
  }
}

TEST_CASE("The leaves of a tree are instances of one", "[procedural]") {
  const Scene scene = grown(R"("shape": "tree", "leaf_material": "white", "leaves": 5000)");
  CHECK(scene.instances.size() == 5000);
  CHECK(scene.prototypes.at(0).triangles.size() == 28);
  CHECK(scene.meshes.size() == 1);  // the wood
  const TempFolder folder;
  CHECK(contains(
      load_failure(folder.write("s.json", with_shapes(R"({"shape": "tree", "material": "white"})")))
          .message,
      "/shapes/0: the key \"leaf_material\" is missing"));
  CHECK(contains(
      load_failure(
          folder.write("s.json",
                       with_shapes(R"({"shape": "tuft", "material": "white", "blades": 0})")))
          .message,
      "/shapes/0/blades: expected a whole number from 1 to 1048576, got 0"));
}

}  // namespace
}  // namespace psf::render
