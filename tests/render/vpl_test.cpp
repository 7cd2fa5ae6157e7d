// Virtual point lights: the mean of `path`, whatever the bound, the set and what surfaces scatter.
#include "light_path_scenes.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

IntegratorSettings vpl(VplSet set, float distance = 0) {
  IntegratorSettings settings;
  settings.name = "vpl";
  settings.vpl_set = set;
  settings.vpl_distance = distance;
  settings.vpl_paths = 4;
  return settings;
}

IntegratorSettings path() {
  return {};
}

}  // namespace

TEST_CASE("Virtual lights: a diffuse furnace has its radiance everywhere, into the corner") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.4f, 0.6f);
  add_room(scene, {wall, wall, wall, wall, wall, wall});
  for (const VplSet set : {VplSet::pass, VplSet::pixel}) {
    for (const SamplerKind kind : kKinds) {
      const auto integrator = make_integrator(scene, vpl(set, 0.3f));
      for (const Vec3& target : {Vec3(0.3f, -1, 0.2f), Vec3(0.97f, -1, 0.96f)}) {
        CAPTURE(set, kind, target.x);
        check(estimate_passes(*integrator, ray({-0.3f, 0.2f, 0.1f}, target), kind, 512, 1, 32), 1);
      }
    }
  }
}

TEST_CASE("Virtual lights agree with path tracing where all kinds of surfaces meet") {
  Scene scene = full_room();
  scene.cameras = {camera_at({0.1f, 0, 0.95f}, {0, -0.3f, -1}, 12)};
  const Estimate expected = estimate_picture(scene, path(), 64);
  for (const VplSet set : {VplSet::pass, VplSet::pixel}) {
    for (const float distance : {0.1f, 0.5f}) {
      CAPTURE(set, distance);
      const IntegratorSettings settings = vpl(set, distance);
      check_agree(estimate_picture(scene, settings, 24), expected, 0.03);
    }
  }
}

TEST_CASE("Virtual lights agree with path tracing under sun, sky and a lamp") {
  Scene scene = open_scene();
  scene.cameras = {camera_at({0.3f, 0.7f, 1.4f}, {0, 0.2f, 0}, 16)};
  check_agree(estimate_picture(scene, vpl(VplSet::pass), 32), estimate_picture(scene, path(), 64),
              0.01);
}

TEST_CASE("Virtual lights agree with path tracing on interpolated normals, seen and lit") {
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.8f);
  scene.meshes.push_back(make_floor(white, 1));
  IntegratorSettings settings = path();
  Ray r = ray({0.9f, 1, 0.3f}, {0.15f, 0.075f, 0});
  SECTION("a smooth roof on a floor whose normals are tilted away from it") {
    scene.meshes.push_back(roof({0, 0, 0}, white));
    scene.meshes[0].normals.assign(4, Vec3(0.5f, 0.8f, 0).normalized());
    scene.lights.push_back(point_light({0.9f, 0.6f, 0.1f}, 1));
    settings.max_depth = 2;
  }
  SECTION("from a tilted floor to a tilted ceiling and back, lit from the floor alone") {
    scene.meshes.push_back(quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white));
    scene.meshes[0].normals.assign(4, Vec3(0.4f, 1, 0.1f).normalized());
    scene.meshes[1].normals.assign(4, Vec3(0.3f, -1, -0.2f).normalized());
    Light spot = point_light({-0.2f, 0.5f, 0.1f}, 1);
    spot.kind = LightKind::spot;
    spot.direction = Vec3(0.5f, -1, 0).normalized();
    spot.cos_inner = 0.95f;
    spot.cos_outer = 0.5f;
    scene.lights.push_back(spot);
    settings.max_depth = 3;
    r = ray({0.5f, 0.8f, 0.9f}, {0.9f, 0, -0.5f});
  }
  const auto paths = make_integrator(scene, settings);
  const Estimate expected = estimate_passes(*paths, r, SamplerKind::sobol, 16384);
  for (const float distance : {0.05f, 0.3f}) {
    CAPTURE(distance);
    IntegratorSettings lights = vpl(VplSet::pass, distance);
    lights.max_depth = settings.max_depth;
    check_agree(estimate_passes(*make_integrator(scene, lights), r, SamplerKind::sobol, 2048),
                expected, 0.01);
  }
}

TEST_CASE(
    "Virtual lights carry what a point light sends through a mirror to a surface that x sees") {
  // The light shines on a mirror floor alone; a wall gets what it reflects, and lights a ceiling.
  Scene scene;
  const int white = add_material(scene, MaterialKind::diffuse, 0.5f);
  const int mirror = add_material(scene, MaterialKind::mirror, 1);
  scene.meshes.push_back(make_floor(mirror, 4));
  scene.meshes.push_back(quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, white));
  Light spot = point_light({0, 1, 0}, 1);
  spot.kind = LightKind::spot;
  spot.direction = Vec3(0, -1, 0);
  spot.cos_outer = 0.85f;
  spot.cos_inner = 0.9f;
  scene.lights.push_back(spot);
  // A small white square below the ceiling, at the side, facing up.
  scene.meshes.push_back(quad({1.0f, 1, 0.1f}, {0.2f, 0, 0}, {0, 0, -0.2f}, white));
  const Ray r = ray({1.1f, 1.5f, 0.3f}, {1.1f, 1, 0});
  IntegratorSettings settings = vpl(VplSet::pass);
  settings.max_depth = 3;  // mirror, ceiling, square
  const Estimate found =
      estimate_passes(*make_integrator(scene, settings), r, SamplerKind::sobol, 1024);
  // What the ceiling gets is the light of the mirrored spot, 1 below the floor; summed over it.
  double expected = 0;
  constexpr int kSteps = 200;
  for (int a = 0; a < kSteps; ++a) {
    for (int b = 0; b < kSteps; ++b) {
      const double x = (a + 0.5) * 2 / kSteps - 1, z = (b + 0.5) * 2 / kSteps - 1;
      const double d_sq = x * x + z * z + 9, cosine = 3 / std::sqrt(d_sq);
      const double t = std::clamp((cosine - 0.85) / (0.9 - 0.85), 0.0, 1.0);
      const double arriving = t * t * (3 - 2 * t) * cosine / d_sq;
      const double to_x = (x - 1.1) * (x - 1.1) + z * z + 1;
      expected += 0.5 / kPiD * arriving * 0.5 / kPiD / (to_x * to_x) * (4.0 / kSteps / kSteps);
    }
  }
  check(found, expected);
  CHECK(estimate(*make(scene, "path"), r, SamplerKind::sobol, 64).mean == 0);
}

TEST_CASE("Virtual lights: splitting leaves the mean") {
  Scene scene = full_room();
  const Ray r = ray({0, 0.2f, 0.5f}, {-0.4f, -0.8f, 0.3f});
  for (const VplSet set : {VplSet::pass, VplSet::pixel}) {
    IntegratorSettings settings = vpl(set);
    const Estimate one =
        estimate_passes(*make_integrator(scene, settings), r, SamplerKind::sobol, 2048);
    settings.split = 4;
    const Estimate four =
        estimate_passes(*make_integrator(scene, settings), r, SamplerKind::sobol, 512);
    check_agree(four, one, 0.02);
  }
}

TEST_CASE("Virtual lights: the same dump for any number of threads, and after a stop") {
  Scene scene = full_room();
  scene.cameras = {camera_at({0.1f, 0, 0.95f}, {0, -0.3f, -1}, 40),
                   camera_at({0.1f, 0.3f, 0.9f}, {0, -0.3f, -1}, 24)};
  for (const VplSet set : {VplSet::pass, VplSet::pixel}) {
    RenderSettings settings = tests::quiet_settings(3);
    settings.cameras = {0, 1};
    settings.integrator = vpl(set);
    settings.integrator.layers = LayerKind::bounces;
    settings.shade_rate = 2;
    settings.sampler.enumeration = set == VplSet::pass ? Enumeration::pixel : Enumeration::global;
    check_same_columns(scene, settings);
  }
}
