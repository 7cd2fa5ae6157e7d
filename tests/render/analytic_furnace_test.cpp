// White furnaces: where every surface emits e and reflects rho, the radiance is e / (1 - rho)
// everywhere.
#include "analytic_support.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

constexpr int kEndless = 10000;

// A room whose surfaces all emit 1 - rho and reflect rho: the radiance is 1.
Scene furnace(MaterialKind other_kind = MaterialKind::diffuse, float rho = 0.4f) {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, rho, 1 - rho);
  const int other = add_material(scene, other_kind, rho, 1 - rho);
  add_room(scene, {wall, wall, wall, other, wall, wall});
  return scene;
}

const Ray kIntoRoom = ray({-0.3f, 0.2f, 0.1f}, {0.9f, 0.1f, 0});

void check_all(const Scene& scene, const Ray& r, double expected, std::uint64_t paths) {
  const auto integrator = make(scene, "path", kEndless);
  for (const SamplerKind kind : kKinds) {
    CAPTURE(kind);
    check(estimate(*integrator, r, kind, paths), expected);
  }
}

}  // namespace

TEST_CASE("Furnace: a diffuse room") {
  check_all(furnace(MaterialKind::diffuse, 0.7f), kIntoRoom, 1, 2048);
}

TEST_CASE("Furnace: a room with a mirror wall") {
  check_all(furnace(MaterialKind::mirror), kIntoRoom, 1, 512);
}

TEST_CASE("Furnace: a sphere seen from inside, where the way into the light is a sphere's inside") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.7f, 0.3f);
  scene.materials[0].emits_two_sided = true;
  scene.spheres.push_back({"", Vec3(0, 0, 0), 3, wall});
  check_all(scene, ray({1, 0, 0}, {0, 2, 1}), 1, 512);
}

TEST_CASE("Furnace: a glass sphere cannot be seen") {
  Scene scene = furnace();
  const int glass = add_material(scene, MaterialKind::glass, 1);
  scene.spheres.push_back({"", Vec3(0.4f, 0.1f, 0.1f), 0.4f, glass});
  check_all(scene, kIntoRoom, 1, 1024);
  check_all(scene, ray({-0.3f, 0.2f, 0.1f}, {0.4f, 0.47f, 0.1f}), 1, 2048);
}

TEST_CASE("Furnace: a glass sphere seen from inside has the radiance of its index squared") {
  Scene scene = furnace();
  const int glass = add_material(scene, MaterialKind::glass, 1);
  scene.spheres.push_back({"", Vec3(0.4f, 0.1f, 0.1f), 0.4f, glass});
  check_all(scene, ray({0.45f, 0.1f, 0.2f}, {0.9f, 0.1f, 0}), 1.5 * 1.5, 1024);
}

TEST_CASE(
    "Furnace: a white coat cannot be seen, whether x_i lies on its base or on what it mirrors") {
  for (const float roughness : {0.0f, 0.15f, 0.6f}) {
    CAPTURE(roughness);
    Scene scene = furnace();
    const int coat = add_material(scene, MaterialKind::coat, 1);
    scene.materials.back().roughness = roughness;
    scene.spheres.push_back({"", Vec3(0.4f, 0.1f, 0.1f), 0.4f, coat});
    const auto integrator = make(scene, "path", kEndless);
    for (const SamplerKind kind : kKinds) {
      const Estimate e =
          estimate(*integrator, ray({-0.3f, 0.2f, 0.1f}, {0.4f, 0.3f, 0.1f}), kind, 1024);
      CAPTURE(kind, e.mean, e.error);
      CHECK(e.error < 0.003);
      CHECK(e.mean < 1.001 + 3 * e.error);
      CHECK(e.mean > 0.995 - 3 * e.error);
    }
  }
}

TEST_CASE("Furnace: white gloss cannot be seen, whatever it reflects itself") {
  for (const float specular : {0.05f, 0.5f, 1.0f}) {
    for (const float roughness : {0.0f, 0.15f, 0.6f}) {
      CAPTURE(specular, roughness);
      Scene scene = furnace();
      const int gloss = add_material(scene, MaterialKind::gloss, 1);
      scene.materials.back().roughness = roughness;
      scene.materials.back().specular = grey(specular);
      scene.spheres.push_back({"", Vec3(0.4f, 0.1f, 0.1f), 0.4f, gloss});
      const auto integrator = make(scene, "path", kEndless);
      const Estimate e = estimate(*integrator, ray({-0.3f, 0.2f, 0.1f}, {0.4f, 0.3f, 0.1f}),
                                  SamplerKind::sobol, 512);
      CAPTURE(e.mean, e.error);
      CHECK(e.error < 0.005);
      CHECK(e.mean < 1.001 + 3 * e.error);
      CHECK(e.mean > 0.995 - 3 * e.error);
    }
  }
}

TEST_CASE("Furnace: white metal cannot be seen, however rough, in a room and under the sky") {
  for (const float roughness : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}) {
    Scene room = furnace(), open;
    open.environment.radiance = grey(1);
    for (Scene* scene : {&room, &open}) {
      const int metal = add_material(*scene, MaterialKind::conductor, 1);
      scene->materials.back().roughness = roughness;
      scene->spheres.push_back({"", Vec3(0.4f, 0.1f, 0.1f), 0.4f, metal});
      const auto integrator = make(*scene, "path", kEndless);
      const Estimate e = estimate(*integrator, ray({-0.3f, 0.2f, 0.1f}, {0.4f, 0.3f, 0.1f}),
                                  SamplerKind::sobol, 1024);
      CAPTURE(roughness, e.mean, e.error);
      CHECK(e.error < 0.002);
      CHECK(std::abs(e.mean - 1) < 0.01);
    }
  }
}

TEST_CASE("Furnace: a diffuse ball under a constant sky has no noise at all") {
  Scene scene;
  const int ball = add_material(scene, MaterialKind::diffuse, 0.75f);
  scene.spheres.push_back({"", Vec3(0, 0, 0), 1, ball});
  scene.environment.radiance = grey(2);
  for (const char* name : {"path", "direct", "vpl"}) {
    const auto integrator = make(scene, name);
    for (std::uint64_t i = 0; i < 256; ++i) {
      const PathRecord r =
          trace(*integrator, ray({0.3f, 0.2f, 4}, {0.1f, 0.2f, 0}), SamplerKind::independent, 0, i);
      CHECK(pixel(r).y == 1.5f);
    }
  }
}

TEST_CASE("Furnace: a sky of one colour is the same light as a map of it, sampled by MIS") {
  for (const MaterialKind kind : {MaterialKind::diffuse, MaterialKind::conductor}) {
    Scene scene;
    const int ball = add_material(scene, kind, 0.75f);
    scene.materials.back().roughness = 0.6f;
    scene.spheres.push_back({"", Vec3(0, 0, 0), 1, ball});
    scene.environment.radiance = grey(2);
    const Ray r = ray({0.3f, 0.2f, 4}, {0.1f, 0.2f, 0});
    const Estimate constant = estimate(*make(scene, "path"), r, SamplerKind::sobol, 1024);
    scene.environment.texture = 0;
    scene.textures.emplace_back(8, 4, std::vector<Rgb>(32, grey(1)));
    const Estimate map = estimate(*make(scene, "path"), r, SamplerKind::sobol, 4096);
    CAPTURE(constant.mean, constant.error, map.mean, map.error);
    CHECK(map.error < 0.003);
    if (kind == MaterialKind::diffuse) CHECK(constant.error < 1e-6);
    CHECK(std::abs(map.mean - constant.mean) < 3 * std::hypot(map.error, constant.error) + 1e-4);
  }
}

TEST_CASE("Furnace: a conductor is never brighter than what it mirrors") {
  for (const float roughness : {0.0f, 0.2f, 0.6f, 1.0f}) {
    Scene scene = furnace();
    const int metal = add_material(scene, MaterialKind::conductor, 1);
    scene.materials.back().roughness = roughness;
    scene.spheres.push_back({"", Vec3(0.4f, 0.1f, 0.1f), 0.4f, metal});
    const auto integrator = make(scene, "path", kEndless);
    const Estimate e = estimate(*integrator, ray({-0.3f, 0.2f, 0.1f}, {0.4f, 0.3f, 0.1f}),
                                SamplerKind::sobol, 1024);
    CAPTURE(roughness, e.mean, e.error);
    CHECK(e.mean < 1.0005 + 3 * e.error);
    CHECK(e.mean > (roughness < 0.3f ? 0.98 : 0.3));
  }
}
