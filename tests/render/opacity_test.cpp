// Masks and blended surfaces: what passes them is what closed forms say, and a path that does knows
// nothing of them.
#include "render/light/opacity.h"

#include "analytic_support.h"
#include "gltf_load.h"
#include "load_support.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

constexpr float kAlbedo = 0.5f;

// A floor under a point light of irradiance 1 at the origin, and what is between.
Scene lit_floor() {
  Scene scene;
  scene.meshes.push_back(make_floor(add_material(scene, MaterialKind::diffuse, kAlbedo)));
  scene.lights.push_back(point_light({0, 4, 0}, 16));
  return scene;
}

// A black sheet at this height, of a material of its own.
Material& add_sheet(Scene& scene, float height, float opacity, float half = 1) {
  const int m = add_material(scene, MaterialKind::diffuse, 0);
  Mesh mesh = quad({-half, height, half}, {2 * half, 0, 0}, {0, 0, -2 * half}, m);
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene.meshes.push_back(mesh);
  scene.materials.back().opacity = opacity;
  return scene.materials.back();
}

// Left half there, right half not: u grows along x.
void make_half(Scene& scene, Material& material) {
  material.opacity_texture = static_cast<int>(scene.textures.size());
  std::vector<Rgb> texels(16, grey(1));
  for (std::size_t i = 8; i < 16; ++i) texels[i] = grey(0);
  scene.textures.emplace_back(16, 1, texels);
}

// From the side, under the sheets.
const Ray kAtOrigin = ray({3, 0.5f, 0}, {0, 0, 0});

}  // namespace

TEST_CASE("A shadow ray brings what all blended surfaces together let through", "[opacity]") {
  for (const char* name : {"path", "direct"}) {
    Scene scene = lit_floor();
    add_sheet(scene, 1, 0.25f);
    add_sheet(scene, 2, 0.2f);
    const PathRecord r = trace(*make(scene, name, 1), kAtOrigin, SamplerKind::sobol, 0, 0);
    CHECK(double{r.contribution.y} == Approx(double{kAlbedo} / kPiD * 0.75 * 0.8).epsilon(1e-5));
  }
}

TEST_CASE("A light is seen where more than half of it arrives", "[opacity]") {
  for (const float opacity : {0.0f, 0.3f, 0.49f, 0.51f, 1.0f}) {
    Scene scene = lit_floor();
    add_sheet(scene, 1, opacity);
    const PathRecord r = trace(*make(scene, "direct"), kAtOrigin, SamplerKind::sobol, 0, 0);
    CHECK(r.visibility == (opacity < 0.5f ? 1u : 0u));
    CHECK(double{r.contribution.y} ==
          Approx(double{kAlbedo} / kPiD * (1 - double{opacity})).margin(1e-6));
  }
}

TEST_CASE("Through the hole of a mask all is as if it were not there", "[opacity]") {
  for (const char* name : {"path", "direct", "vpl", "ao"}) {
    Scene open = lit_floor(), masked = lit_floor();
    open.environment.radiance = masked.environment.radiance = grey(0.25f);
    // Beyond the half that is there, so that no way meets that.
    Material& sheet = add_sheet(masked, 0.25f, 1, 400);
    masked.meshes.back().uvs = {{0.75f, 0}, {0.75f, 0}, {0.75f, 1}, {0.75f, 1}};
    make_half(masked, sheet);
    sheet.opacity_cutoff = 0.5f;
    open.meshes.push_back(quad({-400, -9, 400}, {800, 0, 0}, {0, 0, -800}, 0));
    const auto without = make(open, name, 4), with = make(masked, name, 4);
    std::size_t vertices = 0;
    for (std::uint64_t i = 0; i < 64; ++i) {
      const Ray r = ray({3, 0.5f, 0}, {0.01f * static_cast<float>(i), 0, 0});
      const PathRecord a = trace(*without, r, SamplerKind::sobol, 0, i);
      const PathRecord b = trace(*with, r, SamplerKind::sobol, 0, i);
      CAPTURE(name, i);
      CHECK(a.position == b.position);
      CHECK(a.distance == b.distance);
      CHECK(a.visibility == b.visibility);
      CHECK(a.contribution == b.contribution);
      vertices += a.has_vertex ? 1 : 0;
    }
    CHECK(vertices == 64);
  }
}

TEST_CASE("A mask is whole from its cutoff on, and needs no numbers", "[opacity]") {
  Scene scene = lit_floor();
  Material& sheet = add_sheet(scene, 1, 1);
  make_half(scene, sheet);
  sheet.opacity_cutoff = 0.5f;
  const auto integrator = make(scene, "direct");
  for (std::uint64_t i = 0; i < 32; ++i) {
    // The shadow of the left half, projected from 4 above.
    for (const float x : {-1.2f, -0.6f, -0.1f, 0.1f, 0.6f, 1.2f, 1.4f}) {
      const PathRecord r =
          trace(*integrator, ray({x, 0.5f, 3}, {x, 0, 0}), SamplerKind::independent, 0, i);
      CHECK(r.visibility == (x < 0 ? 0u : 1u));
    }
  }
  CHECK(Opacity{0.4f, nullptr, 0.4f}.at({0, 0}) == 1);
  CHECK(Opacity{0.4f, nullptr, 0.41f}.at({0, 0}) == 0);
  CHECK(Opacity{0.4f, nullptr, 0}.at({0, 0}) == 0.4f);
}

TEST_CASE("The camera sees a blended surface over what is behind, and alpha with it", "[opacity]") {
  Scene scene;
  const int front = add_material(scene, MaterialKind::diffuse, 0, 3);
  const int back = add_material(scene, MaterialKind::diffuse, 0, 1);
  scene.materials[0].opacity = 0.25f;
  scene.materials[1].opacity = 0.5f;
  scene.meshes.push_back(quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, front));
  scene.meshes.push_back(quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, back));
  scene.environment.radiance = grey(0.125f);
  const auto integrator = make(scene, "path");
  const Ray r = ray({0.1f, 0.2f, 3}, {0, 0, 0});
  check(estimate(*integrator, r, SamplerKind::sobol, 4096), 0.25 * 3 + 0.75 * 0.5 + 0.375 * 0.125);
  double covered = 0;
  for (std::uint64_t i = 0; i < 4096; ++i) {
    const PathRecord record = trace(*integrator, r, SamplerKind::sobol, 0, i);
    covered += double{record.coverage};
    const bool far = record.coverage > 0 && record.unfiltered.y == 1;
    if (far)
      CHECK(double{record.distance} == Approx(4 / 3.0 * double((Vec3(0.1f, 0.2f, 3)).length())));
  }
  CHECK(covered / 4096 == Approx(1 - 0.75 * 0.5).margin(0.01));
}

TEST_CASE("A blended lamp lights by its share, however it is found", "[opacity]") {
  // A disk-like quad close above the floor seen by light sampling and scattering together.
  double whole = 0;
  for (const float opacity : {1.0f, 0.25f}) {
    Scene scene;
    scene.meshes.push_back(make_floor(add_material(scene, MaterialKind::diffuse, kAlbedo)));
    const int lamp = add_material(scene, MaterialKind::diffuse, 0, 2);
    scene.materials.back().opacity = opacity;
    scene.meshes.push_back(quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, lamp));
    const auto integrator = make(scene, "path", 2);
    const Estimate e = estimate(*integrator, kAtOrigin, SamplerKind::sobol, 2048);
    if (opacity == 1) {
      whole = e.mean;
      // The form factor of a square of 2 x 2 seen from 1 below its middle.
      const double factor = std::atan(1 / std::sqrt(2.0)) / std::sqrt(2.0);
      CHECK(e.mean == Approx(double{kAlbedo} * 2 * 4 / kPiD * factor).epsilon(0.01));
    } else {
      check(e, whole * 0.25);
    }
  }
}

TEST_CASE("Paths from the lights and from the camera agree about masks and blending", "[opacity]") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.6f);
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, 4);
  add_room(scene, {wall, lamp, wall, wall, wall, wall});
  const int sheet = add_material(scene, MaterialKind::diffuse, 0.7f);
  scene.materials.back().opacity = 0.4f;
  scene.meshes.push_back(quad({-0.7f, 0, 0.7f}, {1.4f, 0, 0}, {0, 0, -1.4f}, sheet));
  const Ray r = ray({-0.8f, -0.5f, 0.1f}, {0.3f, -1, 0.2f});
  const Estimate path = estimate(*make(scene, "path", 6), r, SamplerKind::sobol, 4096);
  IntegratorSettings settings;
  settings.name = "vpl";
  settings.max_depth = 6;
  settings.vpl_set = VplSet::pixel;
  settings.vpl_paths = 4;
  const auto vpl = make_integrator(scene, settings);
  const Estimate by_lights = estimate(*vpl, r, SamplerKind::sobol, 2048);
  CAPTURE(path.mean, path.error, by_lights.mean, by_lights.error);
  CHECK(path.error < 0.005 * path.mean);
  CHECK(by_lights.error < 0.005 * path.mean);
  CHECK(std::abs(path.mean - by_lights.mean) < 3 * std::hypot(path.error, by_lights.error));
}

TEST_CASE("Sheets without end let no ray hang", "[opacity]") {
  Scene scene = lit_floor();
  add_sheet(scene, 1, 0);
  const Mesh one = scene.meshes.back();
  for (int k = 0; k < RayCaster::kMostPassed + 2; ++k) {
    Mesh mesh = one;
    for (Vec3& p : mesh.positions) p.y += 0.0005f * static_cast<float>(k);
    scene.meshes.push_back(mesh);
  }
  const PathRecord r = trace(*make(scene, "direct"), kAtOrigin, SamplerKind::sobol, 0, 0);
  CHECK(r.contribution.y == 0);
}

TEST_CASE("Opacity in JSON, MTL and glTF is what the file says", "[opacity][load]") {
  const TempFolder folder;
  folder.write("g.ppm", ppm(2, "51 51 51 255 255 255"));
  const Scene scene = load_scene(folder.write("s.json", R"({"materials": [
      {"name": "leaf", "opacity_map": "g.ppm", "opacity_cutoff": 0.5},
      {"name": "veil", "opacity": 0.25}, {"name": "whole"}],
      "shapes": [{"shape": "sphere", "center": [0, 0, 0], "radius": 1, "material": "leaf"}]})"));
  const auto of = [&](std::size_t m, float u) {
    return Opacity::of(scene.materials.at(m), scene).at({u, 0.5f});
  };
  CHECK(of(0, 0.25f) == 0);
  CHECK(of(0, 0.75f) == 1);
  CHECK(of(1, 0) == 0.25f);
  CHECK(Opacity::of(scene.materials[2], scene).full());
  CHECK(contains(load_failure(folder.write("t.json", R"({"materials": [{"name": "m",
      "opacity": 2}], "shapes": []})"))
                     .message,
                 "/materials/0/opacity: expected a number in [0, 1]"));

  folder.write("m.mtl",
               "newmtl m\nKd 1 1 1\nd 0.75\nmap_d g.ppm\nnewmtl n\nKd 1 1 1\nd 0.2\nmap_d g.ppm\n");
  const Scene obj = load_scene(folder.write(
      "s.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\n"));
  CHECK(notes(obj, "left out") == 0);
  CHECK(obj.materials.at(0).kind == MaterialKind::diffuse);
  CHECK(Opacity::of(obj.materials[0], obj).at({0.25f, 0.5f}) == Approx(0.75 * 0.2));
  CHECK(obj.materials.at(1).kind == MaterialKind::diffuse);  // a sheet, no glass
  CHECK(Opacity::of(obj.materials[1], obj).at({0.75f, 0.5f}) == Approx(0.2));
}

TEST_CASE("glTF's alpha is the base colour's, as a mask or blended", "[opacity][load]") {
  // A PNG of two texels with alpha 51 and 255.
  const std::string uri =
      "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEElEQVR42mP4"
      "//+/MRD/BwAf6QctjL6EugAAAABJRU5ErkJggg==";
  const auto loaded = [&](json material) {
    material["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 1, 1, 0.75}},
                                        {"baseColorTexture", {{"index", 0}}}};
    Document d = with_material(material);
    d.root["images"] = json::array({{{"uri", uri}}});
    d.root["textures"] = json::array({{{"source", 0}}});
    return load(d);
  };
  const auto at = [](const Scene& scene, float u) {
    return double{Opacity::of(scene.materials.at(0), scene).at({u, 0.5f})};
  };
  const Scene blend = loaded({{"alphaMode", "BLEND"}});
  CHECK(notes(blend, "alpha") == 0);
  CHECK(at(blend, 0.25f) == Approx(0.75 * 0.2));
  CHECK(at(blend, 0.75f) == Approx(0.75));
  const Scene mask = loaded({{"alphaMode", "MASK"}});
  CHECK(at(mask, 0.25f) == 0);
  CHECK(at(mask, 0.75f) == 1);
  CHECK(at(loaded({{"alphaMode", "MASK"}, {"alphaCutoff", 0.1}}), 0.25f) == 1);
  CHECK(at(loaded({{"alphaMode", "MASK"}, {"alphaCutoff", 1.5}}), 0.75f) == 0);
  CHECK(Opacity::of(loaded({{"alphaMode", "MASK"}, {"alphaCutoff", 0}}).materials.at(0), mask)
            .full());
  CHECK(Opacity::of(loaded({{"alphaMode", "OPAQUE"}}).materials.at(0), mask).full());
  CHECK(Opacity::of(loaded(json::object()).materials.at(0), mask).full());
}
