// TANGENT of glTF: the frame of normal maps, and what becomes of it in the scene.
#include "analytic_support.h"
#include "gltf_load.h"
#include "load_support.h"
#include "render/light/transport.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

using TangentOfFile = std::array<float, 4>;

// A triangle in the plane z = 0 with normals, texture coordinates whose u is along x and v along y,
// the same tangent at all corners, and a normal map.
Document mapped_triangle(const TangentOfFile& tangent) {
  Document d = triangle();
  json& primitive = d.root["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] =
      d.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3", 3);
  primitive["attributes"]["TEXCOORD_0"] =
      d.accessor(std::vector<float>{0, 1, 1, 1, 0, 0}, 5126, "VEC2", 2);
  std::vector<float> tangents;
  for (int k = 0; k < 3; ++k) tangents.insert(tangents.end(), tangent.begin(), tangent.end());
  primitive["attributes"]["TANGENT"] = d.accessor(tangents, 5126, "VEC4", 4);
  primitive["material"] = 0;
  d.root["materials"] = {{{"normalTexture", {{"index", 0}}}, {"doubleSided", true}}};
  d.root["images"] = {{{"uri", "data:image/png;base64," + kPng}}};
  d.root["textures"] = {{{"source", 0}}};
  return d;
}

// The normal where a ray from `from` meets `at`, with a map that says x and y everywhere.
Vec3 mapped_normal(Scene scene, float x, float y, const Vec3& from, const Vec3& at) {
  const float z = std::sqrt(1 - x * x - y * y);
  const auto stored = [](float n) { return 0.5f * n + 0.5f; };
  scene.textures.at(static_cast<std::size_t>(scene.materials.at(0).normal_texture)) =
      Texture(1, 1, std::vector<Rgb>{Rgb(stored(x), stored(y), stored(z))});
  scene.materials[0].kind = MaterialKind::diffuse;
  return trace(*make(scene, "direct"), ray(from, at), SamplerKind::sobol, 0, 0).normal;
}

const Vec3 kPlace(0.25f, 0.25f, 0), kEyeAbove(0.25f, 0.25f, 3);

}  // namespace

TEST_CASE("Tangents of a file turn the normals of its map, w their other axis", "[relief][gltf]") {
  // u along y: by w, v along -x (n x t) or +x.
  check_point(mapped_normal(load(mapped_triangle({0, 1, 0, 1})), 0.48f, 0.36f, kEyeAbove, kPlace),
              {-0.36f, 0.48f, 0.8f});
  check_point(mapped_normal(load(mapped_triangle({0, 1, 0, -1})), 0.48f, 0.36f, kEyeAbove, kPlace),
              {0.36f, 0.48f, 0.8f});
  // From behind it is the same surface, turned over.
  check_point(
      mapped_normal(load(mapped_triangle({0, 1, 0, -1})), 0.48f, 0.36f, {0.25f, 0.25f, -3}, kPlace),
      {-0.36f, -0.48f, -0.8f});
  // Those that the texture coordinates say change nothing.
  Document plain = mapped_triangle({1, 0, 0, 1});
  const Vec3 with = mapped_normal(load(plain), 0.48f, 0.36f, kEyeAbove, kPlace);
  plain.root["meshes"][0]["primitives"][0]["attributes"].erase("TANGENT");
  check_point(with, mapped_normal(load(plain), 0.48f, 0.36f, kEyeAbove, kPlace));
  check_point(with, {0.48f, 0.36f, 0.8f});
}

TEST_CASE("Tangents move with their node, and a mirror turns them over", "[relief][gltf]") {
  Document d = mapped_triangle({0, 1, 0, 1});
  const double root = std::sqrt(0.5);
  // A quarter turn about z: y becomes -x.
  d.root["nodes"][0]["rotation"] = {0, 0, root, root};
  check_point(mapped_normal(load(d), 0.48f, 0.36f, {-0.25f, 0.25f, 3}, {-0.25f, 0.25f, 0}),
              {-0.48f, -0.36f, 0.8f});
  // Mirrored in x what was along -x is along x; the normal stays on the same side.
  d = mapped_triangle({0, 1, 0, 1});
  d.root["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene mirrored = load(d);
  check_point(mapped_normal(mirrored, 0.48f, 0.36f, {-0.25f, 0.25f, 3}, {-0.25f, 0.25f, 0}),
              {0.36f, 0.48f, 0.8f});
  CHECK(mirrored.meshes.at(0).tangents.at(0).w == -1);
}

TEST_CASE("Instances have the tangents of their shape", "[relief][gltf]") {
  // A strip of 16 triangles, 8,192 times: instances; mirrored and turned by their node.
  Document d = mapped_triangle({0, 1, 0, 1});
  std::vector<float> strip, normals, uvs, tangents, places;
  for (int k = 0; k < 18; ++k) {
    const auto x = static_cast<float>(k / 2), y = static_cast<float>(k % 2);
    strip.insert(strip.end(), {x, y, 0});
    normals.insert(normals.end(), {0, 0, 1});
    uvs.insert(uvs.end(), {x, 1 - y});
    tangents.insert(tangents.end(), {0, 1, 0, 1});
  }
  for (int k = 0; k < 8192; ++k) {
    for (const int v : {k % 64 * 10, k / 64 * 10, 0}) places.push_back(static_cast<float>(v));
  }
  json& primitive = d.root["meshes"][0]["primitives"][0];
  primitive["mode"] = 5;
  primitive.erase("indices");
  primitive["attributes"] = {{"POSITION", d.accessor(strip, 5126, "VEC3", 3)},
                             {"NORMAL", d.accessor(normals, 5126, "VEC3", 3)},
                             {"TEXCOORD_0", d.accessor(uvs, 5126, "VEC2", 2)},
                             {"TANGENT", d.accessor(tangents, 5126, "VEC4", 4)}};
  d.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", d.accessor(places, 5126, "VEC3", 3)}};
  d.root["nodes"][0]["scale"] = {-1, 1, 1};
  const Scene scene = load(d);
  REQUIRE(scene.prototypes.size() == 1);
  check_point(mapped_normal(scene, 0.48f, 0.36f, {-20.25f, 30.25f, 3}, {-20.25f, 30.25f, 0}),
              {0.36f, 0.48f, 0.8f});
}

TEST_CASE("Tangents are read where a normal map wants them, and count", "[relief][gltf]") {
  const Scene scene = load(mapped_triangle({0, 1, 0, 1}));
  CHECK(scene.warnings.size() == notes(scene, "nothing in the scene gives light"));
  CHECK(scene.meshes.at(0).tangents.size() == 3);
  CHECK(scene.hash != load(mapped_triangle({1, 0, 0, 1})).hash);
  Document d = mapped_triangle({0, 1, 0, 1});
  d.root["materials"][0].erase("normalTexture");
  CHECK(load(d).meshes.at(0).tangents.empty());
  // Without normals glTF has none.
  d = mapped_triangle({0, 1, 0, 1});
  d.root["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
  CHECK(load(d).meshes.at(0).tangents.empty());
  d = mapped_triangle({0, 1, 0, 1});
  const int few = d.accessor(std::vector<float>{1, 0, 0, 1}, 5126, "VEC4", 4);
  d.root["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = few;
  CHECK(
      contains(failure_of(d).message, "/attributes/TANGENT: TANGENT and POSITION have different"));
}
