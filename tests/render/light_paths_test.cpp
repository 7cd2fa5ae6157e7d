// Light paths: the power that lights send out arrives where closed forms say, and none is lost or
// made on the way.
#include "render/light/light_paths.h"

#include "analytic_support.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

constexpr std::uint64_t kSetPaths = 4096;

IntegratorSettings deep_settings() {
  IntegratorSettings settings;
  settings.max_depth = 1000;
  return settings;
}

SamplerSettings light_numbers(std::uint64_t seed, SamplerKind kind = SamplerKind::sobol) {
  SamplerSettings settings;
  settings.kind = kind;
  settings.seed = seed;
  return settings;
}

// The power that arrives, summed by weight(vertex), a path, over sets of independent randomisation.
template <class Weight>
Estimate arriving(const Scene& scene, const Weight& weight, std::uint64_t paths = kSetPaths,
                  SamplerKind kind = SamplerKind::sobol) {
  const Transport transport(scene, deep_settings());
  const LightPaths light_paths(transport);
  return batches(16, [&](std::uint32_t b) {
    std::uint64_t rays = 0;
    const auto powers =
        light_paths.collect<double>(light_numbers(b, kind), 0, paths, rays,
                                    [&](const LightVertex& v, std::vector<double>& kept) {
                                      kept.push_back(double{v.power.y} * weight(v));
                                    });
    double sum = 0;
    for (const double power : powers) sum += power;
    return sum / static_cast<double>(paths);
  });
}

double whole(const LightVertex&) {
  return 1;
}

int add_black(Scene& scene) {
  return add_material(scene, MaterialKind::diffuse, 0);
}

void add_black_room(Scene& scene) {
  const int wall = add_black(scene);
  add_room(scene, {wall, wall, wall, wall, wall, wall});
}

// A black floor y = 0 from -1 to 1, on which light is measured, in a wider scene.
Scene patch_scene() {
  Scene scene;
  scene.meshes.push_back(make_floor(add_black(scene), 1));
  scene.meshes.push_back(quad({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}, 0));
  return scene;
}

double on_patch(const LightVertex& v) {
  return v.at.surface.position.y > -0.5f && v.at.out.y > 0 ? 1 : 0;  // on its front
}

}  // namespace

TEST_CASE("A closed black room gets the power of every light in it, each its own") {
  Scene scene;
  add_black_room(scene);
  std::vector<double> expected;
  scene.lights.push_back(point_light({0.1f, 0.2f, 0.3f}, 2));
  expected.push_back(4 * kPiD * 2);
  Light spot = point_light({-0.5f, 0.1f, 0}, 3);
  spot.kind = LightKind::spot;
  spot.direction = Vec3(1, -2, 0.5f).normalized();
  spot.cos_inner = 0.9f;
  spot.cos_outer = 0.6f;
  scene.lights.push_back(spot);
  expected.push_back(2 * kPiD * 3 * (1 - 0.75));  // the falloff is half on average
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, 1.5f);
  scene.meshes.push_back(quad({0.3f, 0.8f, 0}, {0.5f, 0, 0}, {0, 0, 0.4f}, lamp));
  expected.push_back(kPiD * 0.2 * 1.5);
  const int both = add_material(scene, MaterialKind::diffuse, 0, 6);
  scene.materials.back().emits_two_sided = true;
  scene.meshes.push_back(quad({-0.3f, 0, 0.5f}, {0.2f, 0, 0}, {0, 0.2f, 0.1f}, both));
  expected.push_back(2 * kPiD * 0.2 * std::sqrt(0.05) * 6);
  const int bulb = add_material(scene, MaterialKind::diffuse, 0, 4);
  scene.spheres.push_back({"", {0, -0.5f, -0.5f}, 0.1f, bulb});
  expected.push_back(4 * kPiD * kPiD * 0.01 * 4);
  const int shell = add_material(scene, MaterialKind::diffuse, 0, 1);
  scene.materials.back().emits_two_sided = true;
  scene.spheres.push_back({"", {0.5f, -0.5f, 0.5f}, 0.2f, shell});
  expected.push_back(2 * 4 * kPiD * kPiD * 0.04);
  double sum = 0;
  for (std::size_t light = 0; light < expected.size(); ++light) {
    CAPTURE(light);
    const auto own = [&](const LightVertex& v) { return v.light == light ? 1.0 : 0.0; };
    check(arriving(scene, own), expected[light]);
    sum += expected[light];
  }
  for (const SamplerKind kind : kKinds) check(arriving(scene, whole, kSetPaths, kind), sum);
}

TEST_CASE("A textured light sends out the mean of its texels") {
  Scene scene;
  add_black_room(scene);
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, 1);
  scene.materials.back().emission_texture = 0;
  scene.textures.emplace_back(2, 1, std::vector<Rgb>{grey(1), grey(5)});
  Mesh mesh = quad({-0.5f, 0.5f, -0.5f}, {1, 0, 0}, {0, 0, 1}, lamp);
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene.meshes.push_back(mesh);
  check(arriving(scene, whole), kPiD * 3);
}

TEST_CASE("A point and a sphere light send their solid angle's share through a square") {
  Scene scene = patch_scene();
  const double h = 1.5, angle = 4 * std::asin(1 / (1 + h * h));
  SECTION("point") {
    scene.lights.push_back(point_light({0, 1.5f, 0}, 2));
    check(arriving(scene, on_patch, 16384), 2 * angle);
  }
  SECTION("sphere") {
    const int bulb = add_material(scene, MaterialKind::diffuse, 0, 3);
    scene.spheres.push_back({"", {0, 1.5f, 0}, 0.4f, bulb});
    check(arriving(scene, on_patch, 16384), kPiD * 0.16 * 3 * angle);
  }
}

TEST_CASE("A square light sends its configuration factor to the square below") {
  Scene scene = patch_scene();
  const int lamp = add_material(scene, MaterialKind::diffuse, 0, 2);
  scene.meshes.push_back(quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, lamp));
  const double x = 2, x_sq = x * x, root = std::sqrt(1 + x_sq);
  const double factor = 2 / (kPiD * x_sq) *
                        (std::log((1 + x_sq) / std::sqrt(1 + 2 * x_sq)) +
                         2 * x * root * std::atan(x / root) - 2 * x * std::atan(x));
  check(arriving(scene, on_patch, 16384), kPiD * 4 * 2 * factor);
}

TEST_CASE("The sun and the sky send their irradiance, times the area") {
  Scene scene = patch_scene();
  SECTION("sun, without and with an angle") {
    Light sun;
    sun.kind = LightKind::directional;
    sun.direction = Vec3(-3, -4, 0).normalized();
    sun.intensity = grey(2);
    for (const float angle : {0.0f, 0.3f}) {
      CAPTURE(angle);
      sun.angle = angle;
      scene.lights = {sun};
      check(arriving(scene, on_patch, 32768), 2 * 0.8 * 4);
    }
  }
  SECTION("constant sky") {
    scene.environment.radiance = grey(0.5f);
    check(arriving(scene, on_patch, 32768), 0.5 * kPiD * 4);
  }
  SECTION("map, whose one half is brighter, and turned") {
    scene.environment.radiance = grey(0.5f);
    scene.environment.rotation = 0.7f;
    scene.environment.texture = 0;
    scene.textures.emplace_back(2, 2, std::vector<Rgb>{grey(1), grey(5), grey(1), grey(5)});
    check(arriving(scene, on_patch, 131072), 0.5 * 3 * kPiD * 4);
  }
}

TEST_CASE("Glass and mirrors pass on all power, however often it crosses them") {
  Scene scene;
  add_black_room(scene);
  const int glass = add_material(scene, MaterialKind::glass, 1);
  scene.materials.back().ior = 1.7f;
  const int mirror = add_material(scene, MaterialKind::mirror, 1);
  scene.spheres.push_back({"", {0, -0.3f, 0}, 0.5f, glass});
  scene.spheres.push_back({"", {0.6f, 0.6f, 0.6f}, 0.2f, mirror});
  scene.spheres.push_back({"", {0, -0.3f, 0}, 0.1f, glass});  // in the other, also with a light
  scene.lights.push_back(point_light({-0.2f, 0.6f, 0.1f}, 1));
  scene.lights.push_back(point_light({0.1f, -0.1f, 0.1f}, 2));
  const auto on_wall = [](const LightVertex& v) { return v.at.surface.material == 0 ? 1.0 : 0.0; };
  check(arriving(scene, on_wall), 4 * kPiD * 3);
}

TEST_CASE("A furnace's surfaces get pi times its radiance") {
  // A room that emits 1 - rho and reflects rho: its radiance is 1.
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f, 0.5f);
  add_room(scene, {wall, wall, wall, wall, wall, wall});
  check(arriving(scene, whole), kPiD * 24);
}

TEST_CASE("A set of light paths does not depend on threads, and each path is its own") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.6f);
  add_room(scene, {wall, wall, wall, wall, wall, wall});
  scene.lights.push_back(point_light({0, 0, 0}, 1));
  const Transport transport(scene, deep_settings());
  const LightPaths paths(transport);
  struct Seen {
    Vec3 position;
    Rgb power;
    std::uint64_t path;
    bool operator==(const Seen&) const = default;
  };
  const auto see = [](const LightVertex& v, std::vector<Seen>& seen) {
    seen.push_back({v.at.surface.position, v.power, v.path});
  };
  std::vector<std::vector<Seen>> sets;
  for (const std::size_t threads : {1u, 2u, 3u}) {
    const core::ThreadLimit limit(threads);
    std::uint64_t rays = 0;
    sets.push_back(paths.collect<Seen>(light_numbers(5), 3, 1000, rays, see));
    CHECK(rays == sets.back().size());  // the room is closed: each ray meets a wall
  }
  CHECK(sets[0].size() > 2000);
  CHECK(sets[1] == sets[0]);
  CHECK(sets[2] == sets[0]);
  std::vector<Seen> in_parts;
  for (const auto& [first, count] : {std::pair(0u, 300u), {300u, 1u}, {301u, 699u}}) {
    std::uint64_t rays = 0;
    const auto part =
        paths.collect_some<Seen>(light_numbers(5), 3, 1000, {first, count}, rays, see);
    in_parts.insert(in_parts.end(), part.begin(), part.end());
  }
  CHECK(in_parts == sets[0]);
  std::vector<Seen> alone;
  Sampler sampler = LightPaths::sampler(light_numbers(5), 3, 1000, 700);
  std::uint64_t rays = 0;
  paths.trace(700, sampler, rays, [&](const LightVertex& v) { see(v, alone); });
  std::vector<Seen> in_set;
  for (const Seen& seen : sets[0]) {
    if (seen.path == 700) in_set.push_back(seen);
  }
  CHECK(alone == in_set);
  // Another pass has other paths.
  CHECK(paths.collect<Seen>(light_numbers(5), 4, 1000, rays, see) != sets[0]);
}

TEST_CASE("A scene without light has no light paths") {
  Scene scene;
  add_black_room(scene);
  CHECK(arriving(scene, whole).mean == 0);
}
