// Media between the surfaces: transmittance and single scattering against closed forms, furnaces, and
// vertices in volumes.
#include <functional>

#include "analytic_support.h"
#include "core/error.h"
#include "render/loop/recorder.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

int add_medium(Scene& scene, const Rgb& sigma_a, const Rgb& sigma_s, float g = 0) {
  Medium medium;
  medium.sigma_a = sigma_a;
  medium.sigma_s = sigma_s;
  medium.g = g;
  scene.media.push_back(medium);
  return static_cast<int>(scene.media.size()) - 1;
}

int add_volume(Scene& scene, int medium) {
  const int material = add_material(scene, MaterialKind::volume, 1);
  scene.materials.back().interior = medium;
  return material;
}

// Six quads facing outward.
void add_block(Scene& scene, const Vec3& low, const Vec3& high, int material) {
  const Vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  for (const Mesh& side :
       {quad(low, x, z, material), quad(high, -z, -x, material), quad(low, z, y, material),
        quad(high, -y, -z, material), quad(low, y, x, material), quad(high, -x, -y, material)}) {
    scene.meshes.push_back(side);
  }
}

Scene furnace_room(float rho = 0.4f) {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, rho, 1 - rho);
  add_room(scene, {wall, wall, wall, wall, wall, wall});
  return scene;
}

const Ray kThroughRoom = ray({-0.7f, 0.2f, 0.1f}, {0.9f, 0.1f, 0});

// Composite Simpson of f from 0 to `end`.
double integral_to(double end, const std::function<double(double)>& f) {
  constexpr int kSteps = 4000;
  double sum = f(0) + f(end);
  for (int k = 1; k < kSteps; ++k) sum += f(end * k / kSteps) * (k % 2 == 1 ? 4 : 2);
  return sum * end / kSteps / 3;
}

double henyey_greenstein(double g, double cosine) {
  return (1 - g * g) / (4 * kPiD * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

}  // namespace

TEST_CASE("Volume: what absorbs leaves exp(-sigma distance) of each colour") {
  const Rgb sigma(0.2f, 1, 3);
  Scene everywhere, block;
  for (Scene* scene : {&everywhere, &block}) {
    const int lamp = add_material(*scene, MaterialKind::diffuse, 0, 2);
    scene->meshes.push_back(quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, lamp));
    const int medium = add_medium(*scene, sigma, Rgb(0, 0, 0));
    if (scene == &everywhere) {
      scene->medium = medium;
    } else {
      add_block(*scene, {-1, -1, -1.5f}, {1, 1, 0}, add_volume(*scene, medium));
    }
  }
  for (const auto& [scene, distance] : {std::pair(&everywhere, 3.0), std::pair(&block, 1.5)}) {
    const auto integrator = make(*scene, "path");
    for (int c = 0; c < 3; ++c) {
      const Estimate e = batches(16, [&](std::uint32_t b) {
        double sum = 0;
        for (std::uint64_t i = 0; i < 256; ++i) {
          const PathRecord r =
              trace(*integrator, {{0.1f, 0.2f, 1}, {0, 0, -1}}, SamplerKind::sobol, b, i);
          sum += double{pixel(r)[c]};
        }
        return sum / 256;
      });
      const double expected = 2 * std::exp(-double{sigma[c]} * distance);
      CAPTURE(c, distance, e.mean, e.error, expected);
      CHECK(std::abs(e.mean - expected) < 3 * e.error + 1e-4 * expected);
      CHECK(e.error < 0.05 * expected + 2e-3);
    }
  }
}

TEST_CASE("Volume: what lies within a volume takes its part of each way, and none of the rest") {
  // 1 is absorbed per unit of length, and on half a unit in the middle 3, or nothing in glass.
  const auto with = [](bool glass) {
    Scene scene;
    const int thin = add_volume(scene, add_medium(scene, Rgb(1, 1, 1), Rgb(0, 0, 0)));
    int inner = add_volume(scene, add_medium(scene, Rgb(3, 3, 3), Rgb(0, 0, 0)));
    if (glass) inner = add_material(scene, MaterialKind::glass, 1);
    scene.materials[static_cast<std::size_t>(inner)].ior = 1;
    add_block(scene, {-1, -1, -1.5f}, {1, 1, 0}, thin);
    add_block(scene, {-0.5f, -0.5f, -1}, {0.5f, 0.5f, -0.5f}, inner);
    return scene;
  };
  for (const bool glass : {false, true}) {
    Scene scene = with(glass);
    const int lamp = add_material(scene, MaterialKind::diffuse, 0, 2);
    scene.meshes.push_back(quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, lamp));
    const auto integrator = make(scene, "path");
    const Estimate e = batches(32, [&](std::uint32_t b) {
      double sum = 0;
      for (std::uint64_t i = 0; i < 512; ++i) {
        const Ray through{{0.1f, 0.2f, 1}, {0, 0, -1}};
        sum += double{pixel(trace(*integrator, through, SamplerKind::sobol, b, i)).y};
      }
      return sum / 512;
    });
    const double expected = 2 * std::exp(glass ? -1.0 : -2.5);
    CAPTURE(glass, e.mean, e.error, expected);
    CHECK(std::abs(e.mean - expected) < 4 * e.error + 1e-4 * expected);
    CHECK(e.error < 0.02);
  }

  // From the floor through both, and through a sheet of which a quarter is there, to a point light.
  Scene scene = with(false);
  const int floor = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.meshes.push_back(quad({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, floor));
  const int sheet = add_material(scene, MaterialKind::diffuse, 0);
  scene.materials[static_cast<std::size_t>(sheet)].opacity = 0.25f;
  scene.meshes.push_back(quad({-1, -1, 0.5f}, {2, 0, 0}, {0, 2, 0}, sheet));
  scene.lights.push_back(point_light({0, 0, 1}, 7));
  const auto integrator = make(scene, "direct");
  const Ray at_floor = ray({0.1f, 0, -1.9f}, {0, 0, -2});
  const double lit = double{pixel(trace(*integrator, at_floor, SamplerKind::sobol, 0, 0)).y};
  CHECK(lit == Approx(0.5 / kPiD * 7 / 9 * 0.75 * std::exp(-2.5)).epsilon(1e-4));
}

TEST_CASE("Volume: single scattering of a point light is its integral along the ray") {
  const double sigma_s = 0.08, sigma_t = 0.2, g = 0.5;
  const Vec3 lamp(0.4f, 1.5f, -3);
  const auto seen = [&](double end, const std::function<double(double)>& light_way) {
    return integral_to(end, [&](double t) {
      const double x = double{lamp.x}, y = double{lamp.y}, z = double{lamp.z} + t;
      const double r = std::sqrt(x * x + y * y + z * z);
      // The angle by which light is turned: it comes along -(x, y, z) and goes on along +z.
      return sigma_s * std::exp(-sigma_t * (t + light_way(r))) * henyey_greenstein(g, -z / r) /
             (r * r);
    });
  };
  const Ray along{{0, 0, 0}, {0, 0, -1}};
  Scene fog;
  const int black = add_material(fog, MaterialKind::diffuse, 0);
  fog.meshes.push_back(quad({-50, -50, -8}, {100, 0, 0}, {0, 100, 0}, black));
  fog.lights.push_back(point_light(lamp, 5));
  fog.medium = add_medium(fog, grey(static_cast<float>(sigma_t - sigma_s)),
                          grey(static_cast<float>(sigma_s)), static_cast<float>(g));
  check(estimate(*make(fog, "direct"), along, SamplerKind::sobol, 2048),
        5 * seen(8, [](double r) { return r; }));

  // In a block between the planes z = -1 and z = -5, of whose boundary nothing is seen.
  Scene block = fog;
  block.medium = kNone;
  add_block(block, {-50, -50, -5}, {50, 50, -1}, add_volume(block, 0));
  const double expected = integral_to(4, [&](double u) {
    const double t = 1 + u;
    const double x = double{lamp.x}, y = double{lamp.y}, z = double{lamp.z} + t;
    const double r = std::sqrt(x * x + y * y + z * z);
    return 5 * sigma_s * std::exp(-sigma_t * (u + r)) * henyey_greenstein(g, -z / r) / (r * r);
  });
  check(estimate(*make(block, "direct"), along, SamplerKind::sobol, 2048), expected);
}

TEST_CASE("Volume: the shaft of a spot light is its integral along rays of every kind") {
  const double sigma_s = 0.08, sigma_t = 0.2;
  Scene fog;
  const int black = add_material(fog, MaterialKind::diffuse, 0);
  fog.meshes.push_back(quad({-50, -50, -8}, {100, 0, 0}, {0, 100, 0}, black));
  fog.meshes.push_back(quad({-50, -6, 50}, {100, 0, 0}, {0, 0, -100}, black));
  fog.meshes.push_back(quad({-50, 6, -50}, {100, 0, 0}, {0, 0, 100}, black));
  Light spot = point_light({0, 2, -3}, 5);
  spot.kind = LightKind::spot;
  spot.direction = Vec3(0.2f, -1, -0.1f).normalized();
  spot.cos_inner = 0.985f;
  spot.cos_outer = 0.94f;
  fog.lights.push_back(spot);
  fog.medium = add_medium(fog, grey(static_cast<float>(sigma_t - sigma_s)),
                          grey(static_cast<float>(sigma_s)));
  const Imath::V3d lamp(spot.position), axis(spot.direction);
  struct Case {
    Ray along;
    double end;  // at a wall
    bool lit;
  };
  // Across the cone; down in it; up out of it; up into it; and past it, before the lamp and behind.
  for (const Case& c :
       {Case{{{0, 0, 0}, {0, 0, -1}}, 8, true},
        Case{{{0.1f, 1, -3.1f}, Vec3(0.1f, -1, 0).normalized()}, 7.03, true},
        Case{{{0.4f, -1, -3.2f}, Vec3(0.3f, 1, 0.1f).normalized()}, 7.34, true},
        Case{{{3, -5, -3}, Vec3(-0.3f, 1, 0).normalized()}, 11.48, true},
        Case{{{0, 3, 0}, {0, 0, -1}}, 8, false}, Case{{{4, 0, 0}, {0, 0, -1}}, 8, false}}) {
    const double expected = integral_to(c.end, [&](double t) {
      const Imath::V3d from = Imath::V3d(c.along.origin) + Imath::V3d(c.along.direction) * t - lamp;
      const double r = from.length(), cosine = from.dot(axis) / r;
      const double rise = std::clamp((cosine - 0.94) / (0.985 - 0.94), 0.0, 1.0);
      return 5 * rise * rise * (3 - 2 * rise) * sigma_s * std::exp(-sigma_t * (t + r)) /
             (4 * kPiD * r * r);
    });
    CAPTURE(c.along.origin, c.along.direction);
    CHECK((expected > 1e-4) == c.lit);
    const Estimate e = estimate(*make(fog, "direct"), c.along, SamplerKind::sobol, 4096);
    if (c.lit) {
      check(e, expected);
    } else {
      CHECK(e.mean == 0);
    }
  }
}

TEST_CASE("Volume: a small sphere light scatters as a point, whether it is sampled or met") {
  Scene point, sphere;
  for (Scene* scene : {&point, &sphere}) {
    const int black = add_material(*scene, MaterialKind::diffuse, 0);
    scene->meshes.push_back(quad({-50, -50, -8}, {100, 0, 0}, {0, 100, 0}, black));
    scene->medium = add_medium(*scene, grey(0.02f), grey(0.1f), -0.3f);
  }
  point.lights.push_back(point_light({0.4f, 1.5f, -3}, 5));
  const int lamp =
      add_material(sphere, MaterialKind::diffuse, 0, static_cast<float>(5 / (kPiD * 0.01 * 0.01)));
  sphere.spheres.push_back({"", Vec3(0.4f, 1.5f, -3), 0.01f, lamp});
  const Ray along{{0, 0, 0}, {0, 0, -1}};
  for (const char* name : {"direct", "path"}) {
    const Estimate a = estimate(*make(point, name), along, SamplerKind::sobol, 4096);
    const Estimate b = estimate(*make(sphere, name), along, SamplerKind::sobol, 4096);
    CAPTURE(name, a.mean, a.error, b.mean, b.error);
    CHECK(std::hypot(a.error, b.error) < 0.02 * a.mean);
    CHECK(std::abs(a.mean - b.mean) < 3 * std::hypot(a.error, b.error) + 3e-3 * a.mean);
  }
}

TEST_CASE("Volume: a furnace, where nothing is absorbed") {
  Scene fog = furnace_room(), block = furnace_room(), glass = furnace_room();
  fog.medium = add_medium(fog, grey(0), Rgb(0.5f, 1, 2), 0.6f);
  add_block(block, {-0.4f, -0.5f, -0.6f}, {0.5f, 0.6f, 0.5f},
            add_volume(block, add_medium(block, grey(0), grey(3))));
  glass.medium = add_medium(glass, grey(0), grey(1));
  const int clear = add_material(glass, MaterialKind::glass, 1);
  glass.spheres.push_back({"", Vec3(0.4f, 0.1f, 0.1f), 0.4f, clear});
  for (const Scene* scene : {&fog, &block, &glass}) {
    check(estimate(*make(*scene, "path", 10000), kThroughRoom, SamplerKind::sobol, 2048), 1);
  }
}

TEST_CASE("Volume: a body that is seen at its surface or in its volume reflects the same") {
  Estimate found[2];
  for (int k = 0; k < 2; ++k) {
    Scene scene;
    const int floor = add_material(scene, MaterialKind::diffuse, 0.5f);
    scene.meshes.push_back(make_floor(floor, 4));
    const int medium = add_medium(scene, grey(0.2f), grey(2), 0.3f);
    const int body =
        add_material(scene, k == 0 ? MaterialKind::subsurface : MaterialKind::volume, 1);
    scene.materials.back().interior = medium;
    scene.materials.back().ior = 1;
    scene.spheres.push_back({"", Vec3(0, 1, 0), 0.8f, body});
    const int lamp = add_material(scene, MaterialKind::diffuse, 0, 4);
    scene.spheres.push_back({"", Vec3(2, 3, 1), 0.7f, lamp});
    found[k] = estimate(*make(scene, "path", 1000), ray({0, 1.5f, 4}, {0.2f, 1.1f, 0}),
                        SamplerKind::sobol, 1024);
  }
  CAPTURE(found[0].mean, found[0].error, found[1].mean, found[1].error);
  const double error = std::hypot(found[0].error, found[1].error);
  CHECK(error < 0.015 * found[0].mean);
  CHECK(std::abs(found[0].mean - found[1].mean) < 3 * error);
}

TEST_CASE("Volume: the vertex is where the path is scattered first") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.meshes.push_back(quad({-9, -9, -6}, {18, 0, 0}, {0, 18, 0}, wall));
  // Its light reaches the near half of the ray alone.
  scene.lights.push_back(point_light({0.5f, 2, -2}, 5));
  scene.meshes.push_back(quad({-9, 1, -9}, {18, 0, 0}, {0, 0, 6}, wall));
  scene.medium = add_medium(scene, Rgb(0.1f, 0.1f, 0.3f), Rgb(0.3f, 0.1f, 0.1f));
  const auto integrator = make(scene, "path");
  int in_volume = 0, on_wall = 0, lit = 0;
  for (std::uint64_t i = 0; i < 256; ++i) {
    const PathRecord r = trace(*integrator, {{0, 0, 0}, {0, 0, -1}}, SamplerKind::sobol, 0, i);
    REQUIRE(r.has_vertex);
    CHECK(r.shaded);
    CHECK(std::abs(r.distance + r.position.z) < 1e-4f);
    CHECK(r.direction == Vec3(0, 0, 1));
    CHECK(r.roughness == 1);
    CHECK(r.coverage == 1);
    if (r.kind == VertexKind::surface) {
      ++on_wall;
      CHECK(std::abs(r.position.z + 6) < 1e-4f);
      CHECK(r.normal.z > 0.99f);
      continue;
    }
    ++in_volume;
    CHECK(r.kind == VertexKind::volume);
    CHECK(r.position.z > -6);
    CHECK(r.normal == Vec3(0, 0, 0));
    CHECK(std::abs(r.reflectance.x - 0.75f) < 1e-5f);
    CHECK(std::abs(r.reflectance.z - 0.25f) < 1e-5f);
    CHECK(r.material == scene.materials.size());
    // The plane y = 1 from z = -3 on is between the lamp and what lies behind it.
    const bool sees = r.position.z > -4;
    if (std::abs(r.position.z + 4) > 0.01f) CHECK((r.visibility == 1) == sees);
    lit += sees ? 1 : 0;
    const PathRecord unshaded =
        trace(*integrator, {{0, 0, 0}, {0, 0, -1}}, SamplerKind::sobol, 0, i, false);
    CHECK(unshaded.position == r.position);
    CHECK(unshaded.visibility == r.visibility);
    CHECK(unshaded.kind == r.kind);
  }
  CHECK(in_volume > 128);
  CHECK(on_wall > 8);
  CHECK(lit > 32);
  const auto has_kind = [](const std::vector<formats::Channel>& channels) {
    return std::any_of(channels.begin(), channels.end(),
                       [](const formats::Channel& c) { return c.name == "kind"; });
  };
  CHECK(integrator->has_volumes());
  CHECK(has_kind(record_channels({}, {}, true)));
  CHECK_FALSE(has_kind(record_channels({}, {}, false)));
}

TEST_CASE("Volume: occlusion does not see media, light paths refuse them") {
  Scene scene;
  const int wall = add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.meshes.push_back(make_floor(wall, 10));
  const int smoke = add_volume(scene, add_medium(scene, grey(1), grey(1)));
  add_block(scene, {-1, 0.5f, -1}, {1, 1, 1}, smoke);
  const PathRecord r =
      trace(*make(scene, "ao"), ray({0.1f, 3, 0.1f}, {0, 0, 0}), SamplerKind::sobol, 0, 0);
  CHECK(r.has_vertex);
  CHECK(std::abs(r.position.y) < 1e-4f);
  CHECK(r.contribution.y == 1);
  IntegratorSettings settings;
  for (const char* name : {"vpl", "photon"}) {
    settings.name = name;
    CHECK_THROWS_AS(make_integrator(scene, settings), Error);
  }
  settings.name = "path";
  settings.vertices = 3;
  CHECK_THROWS_AS(make_integrator(scene, settings), Error);
}
