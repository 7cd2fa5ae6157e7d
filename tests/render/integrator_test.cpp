// The records that integrators write: which vertex, what passes through it, bits and lengths.
#include <cmath>

#include "analytic_support.h"
#include "core/error.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// Looking down at a mirror on the floor that shows a diffuse ceiling at y = 4, which glows where
// told.
Scene mirror_scene(float ceiling_emission) {
  Scene scene;
  const int mirror = add_material(scene, MaterialKind::mirror, 0.9f);
  const int ceiling = add_material(scene, MaterialKind::diffuse, 0.5f, ceiling_emission);
  scene.meshes.push_back(make_floor(mirror));
  scene.meshes.push_back(quad({-100, 4, -100}, {200, 0, 0}, {0, 0, 200}, ceiling));
  return scene;
}

void check_same(const Vec3& a, const Vec3& b, double tolerance = 1e-4) {
  CAPTURE(a.x, a.y, a.z, b.x, b.y, b.z);
  CHECK(double{(a - b).length()} < tolerance);
}

}  // namespace

TEST_CASE("x_i lies behind the mirror, at the length of the whole segment") {
  Scene scene = mirror_scene(2);
  const Ray r = ray({-3, 4.0f - 1e-3f, 0}, {0, 0, 0});
  for (const char* name : {"path", "direct", "vpl", "photon", "ao"}) {
    CAPTURE(name);
    const PathRecord record = trace(*make(scene, name), r, SamplerKind::sobol, 0, 0);
    REQUIRE(record.has_vertex);
    CHECK(record.shaded);
    check_same(record.position, {3, 4, 0}, 5e-3);
    check_same(record.normal, {0, -1, 0});
    check_same(record.direction, Vec3(-3, -4, 0).normalized(), 1e-3);
    CHECK(double{record.distance} == Approx(10).epsilon(1e-3));
    CHECK(record.throughput.y == Approx(0.9));
    CHECK(record.reflectance.y == 0.5f);
    CHECK(record.roughness == 1);
    CHECK(record.material == 1);
    // The emission of x_i itself, seen in the mirror, is unfiltered; ambient occlusion knows no
    // light.
    CHECK(record.unfiltered.y == Approx(std::string(name) == "ao" ? 0 : 1.8));
  }
}

TEST_CASE("Paths without a vertex: the sky, an endless mirror, the back of a one-sided wall") {
  Scene scene;
  const int mirror = add_material(scene, MaterialKind::mirror, 0.5f);
  scene.meshes.push_back(make_floor(mirror));
  scene.environment.radiance = grey(3);
  const Ray down = ray({0, 1, 0}, {0.5f, 0, 0});
  SECTION("the sky, direct and in the mirror") {
    const auto path = make(scene, "path");
    PathRecord record = trace(*path, ray({0, 1, 0}, {0.5f, 2, 0}), SamplerKind::sobol, 0, 0);
    CHECK_FALSE(record.has_vertex);
    CHECK_FALSE(record.shaded);
    CHECK(record.unfiltered.y == 3);
    record = trace(*path, down, SamplerKind::sobol, 0, 0);
    CHECK_FALSE(record.has_vertex);
    CHECK(record.unfiltered.y == Approx(1.5));
    CHECK(record.contribution.y == 0);
  }
  SECTION("mirror against mirror ends at the greatest depth") {
    scene.meshes.push_back(quad({-1000, 2, -1000}, {2000, 0, 0}, {0, 0, 2000}, mirror));
    IntegratorSettings settings;
    settings.max_depth = 5;
    settings.roulette_depth = 100;
    std::uint64_t rays = 0;
    Sampler s = sampler(SamplerKind::sobol, 0, 0);
    const PathRecord record =
        make_integrator(scene, settings)->trace(ray({0, 1, 0}, {0, 0, 0}), s, true, rays);
    CHECK_FALSE(record.has_vertex);
    CHECK(rays == 6);
  }
  SECTION("the back of a one-sided wall") {
    const int wall = add_material(scene, MaterialKind::diffuse, 0.5f, 1);
    scene.materials.back().two_sided = false;
    scene.meshes.push_back(quad({-1, 0.5f, -1}, {0, 0, 2}, {2, 0, 0}, wall));  // front up
    const PathRecord above = trace(*make(scene, "path"), down, SamplerKind::sobol, 0, 0);
    CHECK(above.has_vertex);
    CHECK(above.unfiltered.y == 1);
    const PathRecord below =
        trace(*make(scene, "path"), ray({0, 0.2f, 0}, {0, 1, 0.1f}), SamplerKind::sobol, 0, 0);
    CHECK_FALSE(below.has_vertex);
    CHECK(below.unfiltered.y == 0);
  }
}

TEST_CASE("Through a glass sphere: straight through its centre, x_i is the wall behind") {
  Scene scene;
  const int glass = add_material(scene, MaterialKind::glass, 0.8f);
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.spheres.push_back({"", {0, 0, 0}, 1, glass});
  scene.meshes.push_back(quad({-50, -50, -5}, {100, 0, 0}, {0, 100, 0}, wall));
  const auto path = make(scene, "path");
  int through = 0;
  constexpr int kPaths = 4096;
  for (std::uint64_t i = 0; i < kPaths; ++i) {
    const PathRecord record = trace(*path, {{0, 0, 4}, {0, 0, -1}}, SamplerKind::sobol, 0, i);
    if (!record.has_vertex) continue;
    if (record.distance > 9.5f) continue;  // bounced inside first
    ++through;
    check_same(record.position, {0, 0, -5});
    check_same(record.direction, {0, 0, 1});
    REQUIRE(double{record.distance} == Approx(9));
    REQUIRE(record.throughput.y == Approx(0.64));
    REQUIRE(record.material == 1);
  }
  CHECK(through / double{kPaths} == Approx(0.96 * 0.96).margin(0.005));
}

TEST_CASE("Visibility bits tell which lights x_i sees") {
  Scene scene;
  const int floor = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.meshes.push_back(make_floor(floor));
  scene.meshes.push_back(
      quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, floor));  // a roof above the origin
  scene.lights = {point_light({0, 2, 0}, 1),            // behind the roof
                  point_light({3, 1, 0}, 1),            // seen
                  point_light({0, -1, 0}, 1),           // under the floor
                  point_light({0, 0.5f, 0}, 1)};        // seen
  Light sun;
  sun.kind = LightKind::directional;
  sun.direction = Vec3(-4, -1, 0).normalized();
  scene.lights.push_back(sun);  // seen under the roof's edge
  const int glow = add_material(scene, MaterialKind::diffuse, 0, 1);
  scene.meshes.push_back(
      quad({3, 0.1f, -0.1f}, {0, 0, 0.2f}, {0, 0.2f, 0}, glow));  // faces the origin
  scene.meshes.push_back(quad({-3, 0.1f, -0.1f}, {0, 0, 0.2f}, {0, 0.2f, 0}, glow));  // faces away
  for (const char* name : {"path", "direct"}) {
    const auto integrator = make(scene, name);
    REQUIRE(integrator->light_names().size() == 7);
    for (std::uint64_t i = 0; i < 64; ++i) {
      const PathRecord record =
          trace(*integrator, ray({0.5f, 0.5f, 2}, {0, 0, 0}), SamplerKind::sobol, 0, i);
      REQUIRE(record.visibility == 0b0111010u);
    }
  }
}

TEST_CASE(
    "The first ray from x_i is as long as the way to what it meets, and infinite for a miss") {
  Scene scene;
  const int grey_material = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.meshes.push_back(make_floor(grey_material, 0.01f));
  const bool open = GENERATE(true, false);
  if (!open) scene.spheres.push_back({"", {0, 0, 0}, 7, grey_material});
  for (const char* name : {"path", "direct", "vpl", "photon", "ao"}) {
    const auto integrator = make(scene, name);
    for (std::uint64_t i = 0; i < 64; ++i) {
      const PathRecord record =
          trace(*integrator, ray({1, 1, 1}, {0, 0, 0}), SamplerKind::halton, 0, i);
      REQUIRE(record.has_vertex);
      if (open) {
        REQUIRE(std::isinf(record.hit_distance));
      } else {
        REQUIRE(double{record.hit_distance} == Approx(7).epsilon(1e-5));
      }
    }
  }
}

TEST_CASE(
    "An unshaded path is the same path up to x_i, at the cost of its segment and shadow rays") {
  Scene scene = mirror_scene(2);
  scene.lights.push_back(point_light({0, 1, 0}, 3));
  for (const char* name : {"path", "direct", "vpl", "photon", "ao"}) {
    const auto integrator = make(scene, name);
    Sampler a = sampler(SamplerKind::sobol, 3, 5), b = a;
    std::uint64_t rays_a = 0, rays_b = 0;
    const Ray r = ray({-3, 3, 0}, {0, 0, 0});
    const PathRecord shaded = integrator->trace(r, a, true, rays_a);
    const PathRecord bare = integrator->trace(r, b, false, rays_b);
    CHECK(rays_b == (std::string(name) == "ao" ? 2 : 3));
    CHECK(rays_a >= 3);
    CHECK(bare.has_vertex);
    CHECK_FALSE(bare.shaded);
    CHECK(bare.position == shaded.position);
    CHECK(bare.throughput == shaded.throughput);
    CHECK(bare.unfiltered == shaded.unfiltered);
    CHECK(bare.contribution == Rgb(0, 0, 0));
    // What tells whom it is averaged with.
    CHECK(bare.visibility == shaded.visibility);
    CHECK(bare.visibility == (std::string(name) == "ao" ? 0u : 1u));
    CHECK(std::isnan(bare.hit_distance));
  }
}

TEST_CASE("Direct light is path tracing of depth one") {
  Scene scene = mirror_scene(1);
  scene.spheres.push_back({"", {0, 2, 1}, 0.5f, 1});
  scene.lights.push_back(point_light({1, 1, 0}, 3));
  const auto direct = make(scene, "direct"), path = make(scene, "path", 1),
             deep = make(scene, "path");
  const Ray r = ray({-3, 2, 3}, {0, 4, 0});
  for (const SamplerKind kind : kKinds) {
    const Estimate a = estimate(*direct, r, kind, 512), b = estimate(*path, r, kind, 512);
    CHECK(a.mean == Approx(b.mean).epsilon(1e-6));
    CHECK(estimate(*deep, r, kind, 512).mean > 1.01 * a.mean);
  }
}

TEST_CASE("Splitting at x_i leaves the mean and lowers the noise") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.6f);
  const int light = add_material(scene, MaterialKind::diffuse, 0, 9);
  add_room(scene, {wall, wall, wall, wall, wall, wall});
  scene.spheres.push_back({"", {0.3f, 0.5f, 0}, 0.2f, light});
  const Ray r = ray({-0.5f, 0, 0}, {0.2f, -1, 0.3f});
  for (const char* name : {"path", "direct", "ao"}) {
    for (const SamplerKind kind : kKinds) {
      CAPTURE(name, kind);
      IntegratorSettings settings;
      settings.name = name;
      settings.ao_distance = 0.9f;
      const Estimate one = estimate(*make_integrator(scene, settings), r, kind, 1024);
      settings.split = 8;
      const Estimate eight = estimate(*make_integrator(scene, settings), r, kind, 128);
      CAPTURE(one.mean, one.error, eight.mean, eight.error);
      CHECK(3 * one.error < 0.01 * one.mean);
      CHECK(std::abs(one.mean - eight.mean) < 3 * std::hypot(one.error, eight.error));
      const Estimate few = estimate(*make_integrator(scene, settings), r, kind, 16);
      settings.split = 1;
      CHECK(few.error < 0.7 * estimate(*make_integrator(scene, settings), r, kind, 16).error);
    }
  }
}

TEST_CASE(
    "x_i on the base of a smooth coat, or on what the coat mirrors, with the same mean as one "
    "lobe") {
  Scene scene;
  const int coat = add_material(scene, MaterialKind::coat, 0.5f);
  scene.materials.back().roughness = 0.1f;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f, 0.2f);
  scene.meshes.push_back(make_floor(coat));
  scene.meshes.push_back(quad({-100, 4, -100}, {200, 0, 0}, {0, 0, 200}, wall));
  scene.lights.push_back(point_light({0.5f, 2, 0.5f}, 5));
  const Ray r = ray({-4, 3, 0}, {0, 0, 0});
  IntegratorSettings settings;
  const auto split = make_integrator(scene, settings);
  int on_coat = 0, on_wall = 0;
  for (std::uint64_t i = 0; i < 512; ++i) {
    const PathRecord record = trace(*split, r, SamplerKind::sobol, 0, i);
    REQUIRE(record.has_vertex);
    REQUIRE(record.roughness == 1);
    ++(record.material == 0 ? on_coat : on_wall);
  }
  CHECK(on_coat > 50);
  CHECK(on_wall > 20);
  settings.vertex_roughness = 0.05f;  // now the whole coat is x_i
  const auto whole = make_integrator(scene, settings);
  for (const SamplerKind kind : kKinds) {
    const Estimate a = estimate(*split, r, kind, 8192, 16), b = estimate(*whole, r, kind, 8192, 16);
    CAPTURE(kind, a.mean, a.error, b.mean, b.error);
    CHECK(3 * a.error < 0.015 * a.mean);
    CHECK(std::abs(a.mean - b.mean) < 3 * std::hypot(a.error, b.error));
  }
}

TEST_CASE("Russian roulette changes the noise, not the mean") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f);
  add_room(scene, {wall, wall, wall, wall, wall, wall});
  scene.lights.push_back(point_light({0.2f, 0.5f, 0}, 1));
  const Ray r = ray({-0.5f, 0, 0}, {0.2f, -1, 0.3f});
  IntegratorSettings settings;
  settings.max_depth = 60;
  settings.roulette_depth = 1;
  const auto early = make_integrator(scene, settings);
  settings.roulette_depth = 1000;
  const auto never = make_integrator(scene, settings);
  for (const SamplerKind kind : kKinds) {
    const Estimate a = estimate(*early, r, kind, 2048), b = estimate(*never, r, kind, 256);
    CAPTURE(a.mean, a.error, b.mean, b.error);
    CHECK(3 * a.error < 0.01 * a.mean);
    CHECK(std::abs(a.mean - b.mean) < 3 * std::hypot(a.error, b.error));
  }
}

TEST_CASE("An unknown integrator is an error that lists those there are") {
  std::string message;
  try {
    (void)make(Scene(), "paht");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::usage);
    message = error.what();
  }
  CHECK(message == "no integrator 'paht': use one of path, direct, vpl, photon, ao");
  IntegratorSettings settings;
  settings.split = 0;
  CHECK_THROWS_AS(make_integrator(Scene(), settings), Error);
  settings.split = 1;
  settings.photon_delta = 1;  // the radius would shrink faster than the photons come
  CHECK_THROWS_AS(make_integrator(Scene(), settings), Error);
}
