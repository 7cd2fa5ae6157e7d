// Normal and bump maps: the normals that they make, light by them, and none from behind a surface.
#include "render/light/relief.h"

#include "analytic_support.h"
#include "gltf_load.h"
#include "load_support.h"
#include "render/light/transport.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// A square in the plane z = 0, u along `u` and v along `v` (each +-1), seen from z > 0.
Scene square(float u = 1, float v = 1) {
  Scene scene;
  add_material(scene, MaterialKind::diffuse, 0.5f);
  Mesh mesh = quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0);
  for (const Vec3& p : mesh.positions) mesh.uvs.emplace_back(u * p.x, v * p.y);
  scene.meshes.push_back(mesh);
  return scene;
}

void set_normal(Scene& scene, const Vec3& n, float scale = 1) {
  scene.materials[0].normal_texture = static_cast<int>(scene.textures.size());
  scene.materials[0].normal_scale = scale;
  const Vec3 stored = n * 0.5f + Vec3(0.5f, 0.5f, 0.5f);
  scene.textures.emplace_back(1, 1, std::vector<Rgb>{Rgb(stored.x, stored.y, stored.z)});
}

// Heights that rise from 0 to 1 along u, in the units of a picture that repeats after 1.
void set_ramp(Scene& scene, float height) {
  scene.materials[0].bump_texture = static_cast<int>(scene.textures.size());
  scene.materials[0].bump_height = height;
  std::vector<Rgb> texels;
  for (int x = 0; x < 64; ++x) texels.push_back(grey((static_cast<float>(x) + 0.5f) / 64));
  scene.textures.emplace_back(64, 1, texels);
}

PathRecord seen(const Scene& scene, const Vec3& from, const Vec3& at) {
  return trace(*make(scene, "direct"), ray(from, at), SamplerKind::sobol, 0, 0);
}

const Vec3 kAbove(0.3f, 0.4f, 3), kAt(0.3f, 0.4f, 0);

}  // namespace

TEST_CASE("A normal map turns the normal along u and v, whichever way these lie", "[relief]") {
  for (const float u : {1.0f, -1.0f}) {
    for (const float v : {1.0f, -1.0f}) {
      Scene scene = square(u, v);
      set_normal(scene, {0.48f, 0.36f, 0.8f});
      CAPTURE(u, v);
      check_point(seen(scene, kAbove, kAt).normal, {0.48f * u, 0.36f * v, 0.8f});
      // From behind it is the same surface, turned over.
      check_point(seen(scene, {0.3f, 0.4f, -3}, kAt).normal, {-0.48f * u, -0.36f * v, -0.8f});
    }
  }
  Scene scene = square();
  set_normal(scene, {0.6f, 0, 0.8f}, 0.5f);
  check_point(seen(scene, kAbove, kAt).normal, Vec3(0.3f, 0, 0.8f).normalized());
}

TEST_CASE("Light falls by the mapped normal, and none comes through from behind", "[relief]") {
  Scene scene = square();
  set_normal(scene, {0.6f, 0, 0.8f});
  scene.lights.push_back(point_light(kAt + Vec3(2, 0, 0.5f), 1));
  const double distance_sq = 4.25, cosine = (0.6 * 2 + 0.8 * 0.5) / std::sqrt(distance_sq);
  CHECK(double{seen(scene, kAbove, kAt).contribution.y} ==
        Approx(0.5 / kPiD * cosine / distance_sq).epsilon(1e-4));
  // Below the plane, but before the mapped normal.
  scene.lights[0].position = kAt + Vec3(2, 0, -0.5f);
  CHECK(seen(scene, kAbove, kAt).contribution.y == 0);
}

TEST_CASE("Heights turn the normal by their slope", "[relief]") {
  Scene scene = square();
  set_ramp(scene, 0.75f);
  check_point(seen(scene, kAbove, kAt).normal, {-0.6f, 0, 0.8f});
  check_point(seen(scene, {0.3f, 0.4f, -3}, kAt).normal, {0.6f, 0, -0.8f});
  Scene dense = square(2, 3);  // twice as steep
  set_ramp(dense, 0.375f);
  check_point(seen(dense, {0.2f, 0.4f, 3}, {0.2f, 0.4f, 0}).normal, {-0.6f, 0, 0.8f});
}

TEST_CASE("On a sphere heights rise with the longitude", "[relief]") {
  Scene scene;
  add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.spheres.push_back({"", Vec3(0, 0, 0), 2, 0});
  set_ramp(scene, 1);
  // At the equator u = 1 is 4 pi long, and u grows from -z toward +x.
  const double slope = 1 / (4 * kPiD), norm = std::sqrt(1 + slope * slope);
  const Vec3 n = seen(scene, {5, 0, 0}, {0, 0, 0}).normal;
  check_point(n, Vec3(static_cast<float>(1 / norm), 0, static_cast<float>(-slope / norm)));
  const Vec3 pole = seen(scene, {0, 5, 0}, {0, 0, 0}).normal;
  CHECK(pole.length() == Approx(1));
}

TEST_CASE("Relief makes no light: no normal reflects more than a white sky", "[relief]") {
  for (const float x : {0.3f, 0.7f, 0.95f}) {
    Scene scene = square();
    scene.materials[0].reflectance = grey(1);
    scene.environment.radiance = grey(1);
    set_normal(scene, {x, 0, std::sqrt(1 - x * x)});
    const auto integrator = make(scene, "path");
    for (const float from : {-20.0f, -2.0f, 0.0f, 2.0f, 20.0f}) {
      const Estimate e = estimate(*integrator, ray({from, 0.4f, 2}, kAt), SamplerKind::sobol, 512);
      CAPTURE(x, from, e.mean);
      CHECK(e.mean < 1.0001);
      // The share of the hemisphere around the normal that is above the plane.
      if (from == 20)
        CHECK(e.mean == Approx(0.5 * (1 + std::sqrt(1 - double{x * x}))).margin(0.01));
    }
  }
}

TEST_CASE("Without texture coordinates, or where they span nothing, a surface stays flat",
          "[relief]") {
  Scene scene = square();
  set_normal(scene, {0.6f, 0, 0.8f});
  set_ramp(scene, 1);
  scene.meshes[0].uvs.clear();
  check_point(seen(scene, kAbove, kAt).normal, {0, 0, 1});
  scene.meshes[0].uvs.assign(4, Vec2(0.5f, 0.5f));
  check_point(seen(scene, kAbove, kAt).normal, {0, 0, 1});
}

TEST_CASE("Relief in JSON and MTL is what the file says", "[relief][load]") {
  const TempFolder folder;
  folder.write("n.ppm", ppm(1, "204 128 230"));
  folder.write("h.ppm", ppm(4, "0 0 0 102 102 102 204 204 204 102 102 102"));
  const std::string shape =
      R"("shapes": [{"shape": "quad", "origin": [0, 0, 0], "u": [1, 0, 0], "v": [0, 1, 0],
      "material": "m"}]})";
  const Scene scene = load_scene(folder.write(
      "s.json", R"({"materials": [{"name": "m", "normal_map": "n.ppm", "normal_scale": 0.5,
      "bump_map": "h.ppm", "bump_height": 0.25}], )" +
                    shape));
  const Material& m = scene.materials.at(0);
  CHECK(m.normal_scale == 0.5f);
  CHECK(m.bump_height == 0.25f);
  CHECK(scene.textures.at(static_cast<std::size_t>(m.normal_texture)).texel(0, 0).x == Approx(0.8));
  CHECK(contains(load_failure(folder.write("t.json", R"({"materials": [{"name": "m",
      "bump_map": "h.ppm"}], )" + shape))
                     .message,
                 "bump_height"));

  // A grey picture in MTL is heights, one of colours normals; -bm multiplies both.
  const auto mtl = [&](const std::string& statement) {
    folder.write("m.mtl", "newmtl m\nKd 1 1 1\n" + statement + "\n");
    return load_scene(folder.write("s.obj",
                                   "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 "
                                   "1\nusemtl m\nf 1/1 2/2 3/3\n"));
  };
  const Scene normals = mtl("map_Bump -bm 0.5 n.ppm");
  CHECK(normals.materials.at(0).normal_scale == 0.5f);
  CHECK(normals.textures.at(0).texel(0, 0).x == Approx(0.8));
  const Scene heights = mtl("bump h.ppm");
  // Texel 1 is 0.8 between its neighbours, which are two apart.
  const Vec3 expected = Vec3(-0.4f, 0, 1).normalized();
  const Rgb found = heights.textures.at(0).texel(1, 0);
  check_point({2 * found.x - 1, 2 * found.y - 1, 2 * found.z - 1}, expected);
  CHECK(mtl("bump h.ppm\nnorm n.ppm").textures.size() == 1);
  CHECK(mtl("norm n.ppm\nbump h.ppm").materials.at(0).normal_texture == 0);
}

TEST_CASE("glTF's normal map is read with its scale", "[relief][load]") {
  Document d = with_material({{"normalTexture", {{"index", 0}, {"scale", -0.5}}}});
  d.root["images"] = json::array({{{"uri", "data:image/png;base64," + kPng}}});
  d.root["textures"] = json::array({{{"source", 0}}});
  const Scene scene = load(d);
  const Material& m = scene.materials.at(0);
  CHECK(m.normal_scale == -0.5f);
  // As stored, though the bytes would be sRGB as a colour.
  CHECK(scene.textures.at(static_cast<std::size_t>(m.normal_texture)).texel(0, 0).x ==
        Approx(188 / 255.0));
  CHECK(notes(scene, "scale") == 0);
}
