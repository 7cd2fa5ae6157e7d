// Photons: their density against closed forms that paths from the camera cannot find, and against
// path tracing.
#include <random>

#include "light_path_scenes.h"
#include "render/accel/point_index.h"
#include "render/light/photon_map.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

IntegratorSettings photon(std::uint32_t paths, float radius, float delta = 0) {
  IntegratorSettings settings;
  settings.name = "photon";
  settings.photon_paths = paths;
  settings.photon_radius = radius;
  settings.photon_delta = delta;
  return settings;
}

}  // namespace

TEST_CASE("The points in a ball are those that a search through all finds, in order") {
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> place(-1, 1);
  std::vector<Vec3> points;
  for (int k = 0; k < 3000; ++k) {
    // Many coincide, and many lie in one plane.
    if (k % 5 == 1) points.push_back(points.back());
    points.emplace_back(place(generator), k % 3 == 0 ? 0 : place(generator), place(generator));
  }
  const PointIndex index(points);
  for (int query = 0; query < 300; ++query) {
    const bool on_point = query % 2 == 0;
    const Vec3 center = on_point ? points[static_cast<std::size_t>(query) * 7]
                                 : Vec3(place(generator), place(generator), place(generator));
    const float radius = query % 7 == 0 ? 0 : 0.3f * std::abs(place(generator));
    std::vector<std::uint32_t> expected, found;
    for (std::uint32_t k = 0; k < points.size(); ++k) {
      if (length_sq(points[k] - center) <= radius * radius) expected.push_back(k);
    }
    index.within(center, radius, found);
    CHECK(found == expected);
    if (on_point) CHECK_FALSE(found.empty());
  }
  std::vector<std::uint32_t> none;
  PointIndex({}).within({0, 0, 0}, 1, none);
  CHECK(none.empty());
}

TEST_CASE("Photons from a mirror are the light of the mirrored lamp") {
  // A point light over a mirror floor, and a ceiling that it does not shine on itself.
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.5f);
  const int mirror = add_material(scene, MaterialKind::mirror, 0.8f);
  scene.meshes.push_back(make_floor(mirror, 4));
  scene.meshes.push_back(quad({-2, 2, -2}, {4, 0, 0}, {0, 0, 4}, white));
  Light spot = point_light({0, 1, 0}, 3);
  spot.kind = LightKind::spot;
  spot.direction = Vec3(0, -1, 0);
  spot.cos_outer = 0.8f;
  spot.cos_inner = 0.85f;
  scene.lights.push_back(spot);
  IntegratorSettings settings = photon(20000, 0.15f);
  settings.max_depth = 2;  // without what goes from the ceiling to the mirror and up again
  const auto integrator = make_integrator(scene, settings);
  const Ray r = ray({0, 1.2f, 0.8f}, {0, 2, 0});
  // The mean over the ball's disk, 3 above the mirrored lamp.
  const double r_sq = 0.15 * 0.15, density = 2 * (1 - 3 / std::sqrt(9 + r_sq)) / r_sq;
  for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::halton}) {
    CAPTURE(kind);
    check(estimate_passes(*integrator, r, kind, 2, 1, 8), 0.8 * 3 * 0.5 / kPiD * density);
  }
  CHECK(estimate(*make(scene, "path"), r, SamplerKind::sobol, 64).mean == 0);
}

TEST_CASE("Photons in glass: power does not change where radiance does") {
  // The sun on a floor that lies in glass, seen from outside; no light goes up and comes back.
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.5f);
  const int glass = add_material(scene, MaterialKind::glass, 1);
  scene.materials.back().ior = 1.5f;
  scene.meshes.push_back(make_floor(white, 1));
  Mesh surface = make_floor(glass, 1);
  for (Vec3& p : surface.positions) p.y = 0.2f;
  scene.meshes.push_back(surface);
  Light sun;
  sun.kind = LightKind::directional;
  sun.direction = Vec3(0, -1, 0);
  sun.intensity = grey(2);
  scene.lights.push_back(sun);
  IntegratorSettings settings = photon(20000, 0.1f);
  settings.max_depth = 3;
  const auto integrator = make_integrator(scene, settings);
  // 4 % are reflected at each crossing; radiance that leaves the glass shrinks by the index squared.
  const double expected = 0.96 * 2 * 0.5 / kPiD * 0.96 / 2.25;
  const Ray r = ray({0, 1, 0}, {0, 0, 0});
  check(estimate_passes(*integrator, r, SamplerKind::sobol, 4, 256, 8), expected);
}

TEST_CASE("The radius of a pass is the first one's over the root of the passes to the delta") {
  Scene scene = full_room();
  const IntegratorSettings settings = photon(5000, 0.3f, 0.5f);
  const auto integrator = make_integrator(scene, settings);
  const Transport transport(scene, settings);
  const Ray r = ray({0, 0, 0}, {0.4f, -1, -0.5f});
  SamplerSettings numbers;
  for (const std::uint64_t pass : {0u, 1u, 15u}) {
    std::uint64_t rays = 0;
    const PhotonMap map(transport, numbers, pass, rays);
    const auto tracer = integrator->for_pass(numbers, pass, rays);
    Sampler s(numbers, 0, pass), t = s;
    const PathRecord record = tracer->trace(r, s, true, rays);
    const Rgb direct = make(scene, "direct")->trace(r, t, true, rays).contribution;
    // The floor is diffuse: its radiance is rho / pi times the density.
    const double radius_sq = 0.09 / std::pow(static_cast<double>(pass + 1), 0.5);
    double density = 0;
    for (const Photon& p : map.photons()) {
      const bool near = double{length_sq(p.position - record.position)} < radius_sq;
      if (near && p.geometric_normal.y > 0.5f) density += double{p.power.y};
    }
    CHECK(density > 0);
    CHECK(double{record.contribution.y - direct.y} ==
          Approx(0.7 / kPiD * density / (kPiD * radius_sq)).epsilon(1e-4));
  }
}

TEST_CASE("Photons agree with path tracing, but for the bias at edges") {
  Scene scene;
  IntegratorSettings settings = photon(10000, 0.03f);
  SECTION("in a room with all kinds of surfaces") {
    scene = full_room();
    scene.cameras = {camera_at({0.1f, 0, 0.95f}, {0, -0.3f, -1}, 16)};
  }
  SECTION("under sun, sky and a lamp") {
    scene = open_scene();
    scene.cameras = {camera_at({0.3f, 0.7f, 1.4f}, {0, 0.2f, 0}, 16)};
  }
  const Estimate expected = estimate_picture(scene, {}, 64);
  const Estimate found = estimate_picture(scene, settings, 4, 8);
  CAPTURE(found.mean, found.error, expected.mean, expected.error);
  const double error = std::hypot(found.error, expected.error);
  CHECK(error < 0.015 * expected.mean);
  CHECK(std::abs(found.mean - expected.mean) < 3 * error + 0.005 * expected.mean);
}

TEST_CASE("Photons gather the caustic of a glass ball that long paths find") {
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.6f);
  const int glass = add_material(scene, MaterialKind::glass, 1);
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, 8);
  scene.meshes.push_back(make_floor(white, 2));
  scene.spheres.push_back({"", {0, 0.6f, 0}, 0.5f, glass});
  scene.spheres.push_back({"", {0, 3, 0}, 0.4f, lamp});
  scene.cameras = {camera_at({2, 0.5f, 0}, {0, 0, 0}, 6)};
  scene.cameras[0].fov = 0.08f;  // the caustic fills the picture
  const Estimate expected = estimate_picture(scene, {}, 512);
  const Estimate found = estimate_picture(scene, photon(50000, 0.03f), 4, 8);
  check_agree(found, expected, 0.025);
  // Without the ball the lamp alone is less than half as bright there.
  scene.spheres.erase(scene.spheres.begin());
  CHECK(estimate_picture(scene, {}, 16).mean < 0.5 * expected.mean);
}

TEST_CASE("Photons of no other side, and of no surface at an angle, are gathered") {
  // A thin wall, bright on its far side, on a dark floor that is bright beyond it.
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.8f);
  scene.meshes.push_back(quad({0, 0, 1}, {0, 0, -2}, {0, 2, 0}, white));       // faces -x
  scene.meshes.push_back(quad({0.001f, 0, -1}, {0, 0, 2}, {0, 2, 0}, white));  // faces +x
  scene.meshes.push_back(quad({0.001f, 0, 1}, {1, 0, 0}, {0, 0, -2}, white));
  scene.lights.push_back(point_light({0.8f, 0.5f, 0}, 1));
  const auto integrator = make_integrator(scene, photon(20000, 0.1f));
  for (const float y : {0.02f, 1.0f}) {
    const Ray r = ray({-1, y, 0}, {0, y, 0});
    CHECK(estimate_passes(*integrator, r, SamplerKind::sobol, 1, 1, 2).mean == 0);
  }
}

TEST_CASE("Photons: the layers of the light add up to it, by light, bounces and lobes") {
  Scene scene = full_room();
  scene.lights.push_back(point_light({0.5f, 0.5f, 0}, 0.5f));
  const auto kind = GENERATE(LayerKind::lights, LayerKind::bounces, LayerKind::lobes);
  const auto name = GENERATE("photon", "vpl");
  IntegratorSettings settings = photon(5000, 0.2f);
  settings.name = name;
  settings.layers = kind;
  settings.split = 2;
  const auto integrator = make_integrator(scene, settings);
  const SamplerSettings numbers;
  std::uint64_t rays = 0;
  const auto tracer = integrator->for_pass(numbers, 0, rays);
  bool any = false;
  for (std::uint64_t k = 0; k < 50; ++k) {
    const float x = -0.9f + 0.036f * static_cast<float>(k);
    std::vector<Rgb> c(tracer->layers().size(), Rgb(0)), u(c);
    Sampler s(numbers, 0, k);
    const PathRecord record =
        tracer->trace(ray({0, 0, 0.3f}, {x, -0.9f, -0.9f}), s, true, rays, {{c, u}});
    Rgb sum_c(0), sum_u(0);
    for (const Rgb& layer : c) sum_c += layer;
    for (const Rgb& layer : u) sum_u += layer;
    CHECK(double{sum_c.y} == Approx(double{record.contribution.y}).epsilon(1e-4).margin(1e-6));
    CHECK(double{sum_u.y} == Approx(double{record.unfiltered.y}).epsilon(1e-4).margin(1e-6));
    any = any || sum_c.y > 0;
  }
  CHECK(any);
}

TEST_CASE("Photons: the same dump for any number of threads, and after a stop") {
  Scene scene = full_room();
  scene.cameras = {camera_at({0.1f, 0, 0.95f}, {0, -0.3f, -1}, 24),
                   camera_at({0.1f, 0.3f, 0.9f}, {0, -0.3f, -1}, 16)};
  for (const SamplerKind kind : kKinds) {
    RenderSettings settings = tests::quiet_settings(3);
    settings.cameras = {0, 1};
    settings.integrator = photon(4000, 0.1f, 0.5f);
    settings.integrator.split = 2;
    settings.shade_rate = 2;
    settings.sampler.kind = kind;
    check_same_columns(scene, settings);
  }
}
