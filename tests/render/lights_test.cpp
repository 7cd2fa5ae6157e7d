// Light sampling against scattering: each alone gives the same irradiance, so their densities are
// right.
#include <random>

#include "analytic_support.h"
#include "render/light/distribution.h"
#include "render/light/frame.h"
#include "render/light/transport.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// Irradiance / pi at the origin of a floor by sampling the one light, and by cosine-weighted rays
// that meet it.
Estimate by_light(const Transport& transport, std::size_t light, const Surface& from) {
  return batches(32, [&](std::uint32_t b) {
    double sum = 0;
    constexpr int kPaths = 4096;
    for (std::uint32_t i = 0; i < kPaths; ++i) {
      Sampler s = sampler(SamplerKind::sobol, b, i);
      LightSample sample;
      if (!transport.lights().sample(light, from, {from.position, from.normal}, s.next_2d(),
                                     sample))
        continue;
      const float cosine = dot(sample.direction, from.normal);
      if (cosine > 0) sum += double{sample.weight.y * cosine} / kPiD;
    }
    return sum / kPaths;
  });
}

Estimate by_scattering(const Transport& transport, const Surface& from) {
  return batches(32, [&](std::uint32_t b) {
    double sum = 0;
    constexpr int kPaths = 16384;
    std::uint64_t rays = 0;
    for (std::uint32_t i = 0; i < kPaths; ++i) {
      Sampler s = sampler(SamplerKind::sobol, b, i);
      Walk walk;
      walk.from.position = from.position;
      const Vec3 w = Frame(from.normal).to_world(cosine_hemisphere(s.next_2d()));
      walk.ray = {from.origin_toward(w), w};
      Surface hit;
      Tally tally;
      const bool met = !std::isinf(transport.next_surface(walk, hit, s, rays));
      sum += double{transport.met(walk, met ? &hit : nullptr, tally).y};
    }
    return sum / kPaths;
  });
}

}  // namespace

TEST_CASE("Light sampling and scattering agree for every light with extent") {
  Scene scene;
  scene.meshes.push_back(make_floor(add_material(scene, MaterialKind::diffuse, 0.5f), 0.01f));
  const int light = add_material(scene, MaterialKind::diffuse, 0, 2);
  SECTION("triangles of unequal size, partly below the horizon, both sides") {
    scene.materials.back().emits_two_sided = true;
    Mesh mesh;
    mesh.positions = {{1, -1, 0}, {1, 2, 1}, {1.5f, 1, -1}, {-1, 0.2f, 0}, {-2, 1, 1}, {-1, 3, -1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {3, 4, 3}};
    mesh.material = light;
    scene.meshes.push_back(mesh);
  }
  SECTION("a sphere cut by the horizon") {
    scene.spheres.push_back({"", {1, 0.3f, 0.5f}, 0.7f, light});
  }
  SECTION("a sphere around") {
    scene.materials.back().emits_two_sided = true;
    scene.spheres.push_back({"", {0.5f, 0.3f, 0.5f}, 3, light});
  }
  SECTION("a textured sphere") {
    scene.materials.back().emission_texture = 0;
    scene.textures.emplace_back(
        4, 2,
        std::vector<Rgb>{grey(1), grey(0), grey(3), grey(2), grey(5), grey(0), grey(0), grey(9)});
    scene.spheres.push_back({"", {1, 1, 0.5f}, 0.7f, light});
  }
  SECTION("a blended sphere") {
    scene.materials.back().opacity = 0.75f;
    scene.spheres.push_back({"", {1, 1, 0.5f}, 0.7f, light});
  }
  SECTION("a mesh with holes") {
    scene.materials.back().opacity_texture = 0;
    scene.materials.back().opacity_cutoff = 0.5f;
    scene.textures.emplace_back(2, 2, std::vector<Rgb>{grey(1), grey(0), grey(0), grey(1)});
    Mesh mesh = quad({-1, 1, 1}, {2, 0, 0}, {0, 1, -2}, light);
    mesh.uvs = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
    scene.materials.back().emits_two_sided = true;
    scene.meshes.push_back(mesh);
  }
  SECTION("a wide sun, partly below the horizon") {
    Light sun;
    sun.kind = LightKind::directional;
    sun.direction = Vec3(1, -0.2f, 0).normalized();
    sun.angle = 0.5f;
    scene.lights.push_back(sun);
  }
  SECTION("an environment map") {
    scene.environment.radiance = grey(1);
    scene.environment.texture = 0;
    scene.textures.emplace_back(
        4, 3,
        std::vector<Rgb>{grey(1), grey(0), grey(3), grey(2), grey(5), grey(0), grey(0), grey(9),
                         grey(0), grey(0), grey(0), grey(4)});
  }
  const Transport transport(scene, {});
  std::uint64_t rays = 0;
  Walk walk;
  walk.ray = {{0, 0.5f, 0}, {0, -1, 0}};
  Surface from;
  Sampler unused = sampler(SamplerKind::sobol, 0, 0);
  REQUIRE(transport.next_surface(walk, from, unused, rays) == Approx(0.5));
  const Estimate a = by_light(transport, 0, from), b = by_scattering(transport, from);
  CAPTURE(a.mean, a.error, b.mean, b.error);
  CHECK(a.error < 0.003 * a.mean);
  CHECK(b.error < 0.003 * b.mean);
  CHECK(std::abs(a.mean - b.mean) < 3 * std::hypot(a.error, b.error) + 1e-5);
}

TEST_CASE("Discrete distributions: every share in proportion, none for weight 0, u uniform again") {
  const std::vector<float> weights{0, 3, 0, 1, 4, 0};
  const Distribution distribution(weights);
  CHECK(distribution.total() == 8);
  std::vector<double> count(weights.size()), sum(weights.size());
  constexpr int kSamples = 80000;
  for (int k = 0; k < kSamples; ++k) {
    float u = (static_cast<float>(k) + 0.5f) / kSamples;
    const std::size_t chosen = distribution.sample(u);
    REQUIRE(u >= 0);
    REQUIRE(u < 1);
    ++count[chosen];
    sum[chosen] += double{u};
  }
  for (std::size_t k = 0; k < weights.size(); ++k) {
    CHECK(double{distribution.probability(k)} == double{weights[k]} / 8);
    CHECK(count[k] == Approx(kSamples * double{weights[k]} / 8).margin(1));
    if (weights[k] > 0) CHECK(sum[k] / count[k] == Approx(0.5).epsilon(1e-3));
  }
  float zero = 0, one = 0x1.fffffep-1f;
  CHECK(distribution.sample(zero) == 1);
  CHECK(distribution.sample(one) == 4);
  CHECK(Distribution(std::vector<float>{0, 0}).total() == 0);
}

TEST_CASE(
    "Lights are numbered and named: those without surface, emissive meshes, emissive spheres") {
  Scene scene;
  const int plain = add_material(scene, MaterialKind::diffuse, 0.5f);
  const int light = add_material(scene, MaterialKind::diffuse, 0, 2);
  scene.spheres.push_back({"bulb", {0, 5, 0}, 1, light});
  scene.spheres.push_back({"ball", {0, 9, 0}, 1, plain});
  scene.meshes.push_back(make_floor(plain));
  scene.meshes.push_back(quad({0, 2, 0}, {1, 0, 0}, {0, 0, 1}, light));
  scene.meshes.push_back(quad({0, 3, 0}, {1, 0, 0}, {2, 0, 0}, light));  // no area: no light
  scene.lights.push_back(point_light({0, 1, 0}, 1));
  scene.lights[0].name = "lamp";
  scene.environment.radiance = grey(1);
  CHECK(make(scene, "path")->light_names() == std::vector<std::string>{"lamp", "mesh 1", "bulb"});
}

TEST_CASE("A sphere that glows on both sides does not light its own outside") {
  Scene scene;
  const int glow = add_material(scene, MaterialKind::diffuse, 0.5f, 2);
  scene.materials.back().emits_two_sided = true;
  scene.spheres.push_back({"", {30, 0, 0}, 1, glow});
  const auto path = make(scene, "path");
  for (std::uint64_t i = 0; i < 256; ++i) {
    const PathRecord record =
        trace(*path, ray({30, 0.5f, 4}, {30, 0.3f, 0}), SamplerKind::sobol, 0, i);
    REQUIRE(record.unfiltered.y == 2);
    REQUIRE(record.contribution.y == 0);
    REQUIRE(record.visibility == 0);
  }
}
