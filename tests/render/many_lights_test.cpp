// Scenes of many lights: chosen by a tree they give the picture that they give by power, with less
// noise, and their visibility bits are decided by the place.
#include <algorithm>
#include <random>
#include <set>

#include "analytic_support.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

std::unique_ptr<Integrator> make_with(const Scene& scene, LightSampling sampling,
                                      const std::string& name = "path") {
  IntegratorSettings settings;
  settings.name = name;
  settings.light_sampling = sampling;
  settings.max_depth = 4;
  return make_integrator(scene, settings);
}

void add_lamp(Scene& scene, const Vec3& center, float radius, int material) {
  scene.spheres.push_back({"", center, radius, material});
}

// Lights of every kind, some of which move, over a floor with a wall, and `points` small ones.
Scene scene_of_every_kind(int points) {
  Scene scene;
  scene.meshes.push_back(make_floor(add_material(scene, MaterialKind::diffuse, 0.6f), 5));
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.meshes.push_back(quad({-1, 0, -1}, {2, 0, 0}, {0, 1.5f, 0}, wall));
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> side(-3, 3), height(0.4f, 2), power(0.05f, 1);
  for (int k = 0; k < points; ++k) {
    Light light =
        point_light({side(generator), height(generator), side(generator)}, power(generator));
    if (k % 3 == 0) {
      light.kind = LightKind::spot;
      light.direction = random_direction(generator);
      light.cos_inner = 0.8f;
      light.cos_outer = k % 2 == 0 ? 0.8f : 0.4f;
    }
    scene.lights.push_back(light);
  }
  Light sun;
  sun.kind = LightKind::directional;
  sun.direction = Vec3(1, -1, 0.5f).normalized();
  sun.intensity = grey(0.3f);
  scene.lights.push_back(sun);
  sun.angle = 0.2f;
  sun.direction = Vec3(-1, -0.3f, 0.5f).normalized();
  scene.lights.push_back(sun);
  const int front = add_material(scene, MaterialKind::diffuse, 0, 3);
  const int both = add_material(scene, MaterialKind::diffuse, 0, 2);
  scene.materials.back().emits_two_sided = true;
  for (int k = 0; k < 6; ++k) {
    const Vec3 corner(side(generator), height(generator), side(generator));
    const Vec3 u = random_direction(generator) * 0.4f, v = random_direction(generator) * 0.4f;
    scene.meshes.push_back(quad(corner, u, v, k % 2 == 0 ? front : both));
    add_lamp(scene, {side(generator), height(generator), side(generator)}, 0.1f, front);
  }
  // One mesh of many lamps, which differ in what they bring.
  Mesh lamps;
  lamps.material = front;
  for (std::uint32_t k = 0; k < 40; ++k) {
    const Vec3 corner(side(generator), height(generator), side(generator));
    const Vec3 u = random_direction(generator) * 0.2f, v = random_direction(generator) * 0.2f;
    for (const Vec3& p : {corner, corner + u, corner + v}) lamps.positions.push_back(p);
    lamps.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  scene.meshes.push_back(lamps);
  Mesh moving = quad({1, 1, 0}, {0.5f, 0, 0}, {0, 0.3f, 0.4f}, front);
  moving.motion.resize(2);
  for (const Vec3& p : moving.positions) {
    moving.motion[0].positions.push_back(p);
    moving.motion[1].positions.push_back(p * 1.2f + Vec3(-2, 0.3f, 0.5f));
  }
  scene.meshes.push_back(moving);
  add_lamp(scene, {-1, 1, 1}, 0.2f, both);
  scene.spheres.back().motion = {{{-1, 1, 1}, 0.2f}, {{-2, 0.7f, 0.4f}, 0.1f}};
  return scene;
}

void add_map(Scene& scene) {
  scene.environment.radiance = grey(0.1f);
  scene.environment.texture = 0;
  scene.textures.emplace_back(
      4, 2,
      std::vector<Rgb>{grey(1), grey(0), grey(3), grey(2), grey(5), grey(0), grey(0), grey(9)});
}

std::vector<Ray> views() {
  std::vector<Ray> rays{ray({3, 2, 4}, {0.5f, 0, 0.8f}), ray({0, 2, 5}, {0.2f, 0.7f, -1}),
                        ray({4, 1, 1}, {-2, 0, -2})};
  for (Ray& r : rays) r.time = 0.6f;
  return rays;
}

// Estimates agree where they are off by chance at most.
void check_agree(const Estimate& a, const Estimate& b) {
  CAPTURE(a.mean, a.error, b.mean, b.error);
  CHECK(a.error < 0.01 * a.mean);
  CHECK(std::abs(a.mean - b.mean) < 3.5 * std::hypot(a.error, b.error) + 1e-5);
}

// A grid of small lamps over a floor.
Scene thousand_lamps() {
  Scene scene;
  scene.meshes.push_back(make_floor(add_material(scene, MaterialKind::diffuse, 0.6f), 40));
  const int glow = add_material(scene, MaterialKind::diffuse, 0, 20);
  std::mt19937 generator(2);
  std::uniform_real_distribution<float> side(-16, 16), height(1, 2);
  for (int k = 0; k < 1000; ++k) {
    add_lamp(scene, {side(generator), height(generator), side(generator)}, 0.03f, glow);
  }
  return scene;
}

}  // namespace

TEST_CASE("Lights of every kind, chosen by a tree, give what they give by power") {
  for (const int points : {60, 4}) {  // where x_i samples the strong ones, and where all
    Scene scene = scene_of_every_kind(points);
    add_map(scene);
    for (const char* name : {"direct", "path"}) {
      const auto tree = make_with(scene, LightSampling::tree, name);
      const auto power = make_with(scene, LightSampling::power, name);
      for (const Ray& r : views()) {
        CAPTURE(points, name, r.origin.x);
        check_agree(estimate(*tree, r, SamplerKind::sobol, 1024),
                    estimate(*power, r, SamplerKind::sobol, points > 32 ? 16384 : 1024));
      }
    }
  }
}

TEST_CASE("In fog, light from a tree is what it is by power") {
  Scene scene = scene_of_every_kind(50);
  std::erase_if(scene.lights, [](const Light& l) { return l.kind == LightKind::directional; });
  Medium fog;
  fog.sigma_a = grey(0.02f);
  fog.sigma_s = grey(0.2f);
  scene.media.push_back(fog);
  scene.medium = 0;
  const Ray r = views().front();
  check_agree(estimate(*make_with(scene, LightSampling::tree), r, SamplerKind::sobol, 4096),
              estimate(*make_with(scene, LightSampling::power), r, SamplerKind::sobol, 16384));
}

TEST_CASE("A thousand lamps have a tenth of the variance where a tree chooses") {
  const Scene scene = thousand_lamps();
  const Ray r = ray({0, 2, 9}, {0.3f, 0, 3});
  const Estimate tree =
      estimate(*make_with(scene, LightSampling::tree, "direct"), r, SamplerKind::independent, 64);
  const Estimate power =
      estimate(*make_with(scene, LightSampling::power, "direct"), r, SamplerKind::independent, 64);
  CAPTURE(tree.mean, tree.error, power.mean, power.error);
  CHECK(10 * tree.error * tree.error < power.error * power.error);
}

TEST_CASE("Up to 32 lights `auto` is `power`, above it is the tree, to the last bit") {
  const auto same = [](const Scene& scene, LightSampling a, LightSampling b) {
    const auto one = make_with(scene, a), other = make_with(scene, b);
    bool all = true;
    for (std::uint64_t i = 0; i < 64; ++i) {
      const PathRecord x = trace(*one, views().front(), SamplerKind::sobol, 0, i);
      const PathRecord y = trace(*other, views().front(), SamplerKind::sobol, 0, i);
      all = all && x.contribution == y.contribution && x.unfiltered == y.unfiltered &&
            x.visibility == y.visibility;
    }
    return all;
  };
  using enum LightSampling;
  const Scene few = scene_of_every_kind(10), many = scene_of_every_kind(40);
  CHECK(make_with(few, automatic)->light_names().size() <= 32);
  CHECK(make_with(many, automatic)->light_names().size() > 32);
  CHECK(same(few, automatic, power));
  CHECK_FALSE(same(few, automatic, tree));
  CHECK(same(many, automatic, tree));
  CHECK_FALSE(same(many, automatic, power));
}

TEST_CASE("Of many lights those have bits that bring much, whichever else a path samples") {
  Scene scene = thousand_lamps();
  // Near the place that is looked at; the second is behind a screen.
  const int bright = add_material(scene, MaterialKind::diffuse, 0, 300);
  const int screen = add_material(scene, MaterialKind::diffuse, 0.5f);
  add_lamp(scene, {0, 1, 3}, 0.05f, bright);
  add_lamp(scene, {1.2f, 0.6f, 3}, 0.05f, bright);
  scene.meshes.push_back(quad({0.5f, 0, 2.5f}, {0, 0, 1}, {0, 1, 0}, screen));
  const Ray r = ray({0, 1.5f, 5}, {0, 0, 3});
  const auto seen = [&](LightSampling sampling) {
    const auto integrator = make_with(scene, sampling);
    std::set<std::uint32_t> bits;
    for (std::uint64_t i = 0; i < 256; ++i) {
      const PathRecord shaded = trace(*integrator, r, SamplerKind::sobol, 1, i);
      bits.insert(shaded.visibility);
      REQUIRE(trace(*integrator, r, SamplerKind::sobol, 1, i, false).visibility ==
              shaded.visibility);
    }
    return bits;
  };
  // The thousand and first light has bit 1000 mod 32.
  CHECK(seen(LightSampling::automatic) == std::set<std::uint32_t>{1u << (1000 % 32)});
  CHECK(seen(LightSampling::power).size() > 4);
  scene.meshes.pop_back();
  CHECK(seen(LightSampling::automatic) ==
        std::set<std::uint32_t>{(1u << (1000 % 32)) | (1u << (1001 % 32))});
  CHECK(make_with(scene, LightSampling::automatic)->visibility_rule().find("an eighth") !=
        std::string::npos);
  CHECK(make_with(scene_of_every_kind(4), LightSampling::tree)->visibility_rule().empty());
}
