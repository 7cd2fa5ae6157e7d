// Lights over surfaces against closed forms, for direct and path, over all samplers.
#include <random>

#include "analytic_support.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

constexpr float kRho = 0.7f;

// A scene with a floor of reflectance kRho as its first mesh.
Scene floor_scene() {
  Scene scene;
  scene.meshes.push_back(make_floor(add_material(scene, MaterialKind::diffuse, kRho)));
  return scene;
}

void check_lit(const Scene& scene, const Ray& r, double expected, std::uint64_t paths) {
  for (const char* name : {"direct", "path"}) {
    const auto integrator = make(scene, name);
    for (const SamplerKind kind : kKinds) {
      CAPTURE(name, kind);
      check(estimate(*integrator, r, kind, paths), expected);
    }
  }
}

}  // namespace

TEST_CASE("A sphere light wholly above the horizon gives pi L (R / d)^2 cos") {
  Scene scene = floor_scene();
  const int light = add_material(scene, MaterialKind::diffuse, 0, 5);
  scene.spheres.push_back({"", Vec3(0, 3, 0), 1.2f, light});
  for (const float x : {0.0f, 1.0f, 2.5f}) {
    CAPTURE(x);
    const double d_sq = double{x} * double{x} + 9, cosine = 3 / std::sqrt(d_sq);
    check_lit(scene, ray({x + 1, 0.3f, 4}, {x, 0, 0}), double{kRho} * 5 * 1.44 / d_sq * cosine,
              1024);
  }
}

TEST_CASE("A far and a tiny sphere light are as exact as a near one") {
  Scene scene = floor_scene();
  const int light = add_material(scene, MaterialKind::diffuse, 0, 1e6f);
  scene.spheres.push_back({"", Vec3(0, 50, 0), 0.05f, light});
  check_lit(scene, ray({1, 1, 1}, {0, 0, 0}), double{kRho} * 1e6 * 1e-6, 256);
}

TEST_CASE("A rectangular light gives its form factor") {
  Scene scene = floor_scene();
  const int light = add_material(scene, MaterialKind::diffuse, 0, 2);
  // One corner straight above the origin, facing down.
  scene.meshes.push_back(quad({0, 2, 0}, {3, 0, 0}, {0, 0, 1.5f}, light));
  const double a = 1.5, b = 0.75, pa = std::sqrt(1 + a * a), pb = std::sqrt(1 + b * b);
  const double form = (a / pa * std::atan(b / pa) + b / pb * std::atan(a / pb)) / (2 * kPiD);
  check_lit(scene, ray({-1, 1, -2}, {0, 0, 0}), double{kRho} * 2 * form, 1024);
}

TEST_CASE("A rectangle emits from its front alone, or from both sides") {
  Scene scene = floor_scene();
  const int light = add_material(scene, MaterialKind::diffuse, 0, 2);
  scene.meshes.push_back(quad({-1, 2, -1}, {0, 0, 2}, {2, 0, 0}, light));  // faces up
  check_lit(scene, ray({-4, 1, -2}, {0, 0, 0}), 0, 64);
  scene.materials.back().emits_two_sided = true;
  const double q = std::sqrt(1.25), form = 4 * 2 * (0.5 / q * std::atan(0.5 / q)) / (2 * kPiD);
  check_lit(scene, ray({-4, 1, -2}, {0, 0, 0}), double{kRho} * 2 * form, 1024);
}

TEST_CASE("A textured light is the sum of its texels") {
  Scene scene = floor_scene();
  const int light = add_material(scene, MaterialKind::diffuse, 0, 1);
  scene.materials.back().emission_texture = 0;
  // Bilinear and repeating with two columns: 1 + cos-like zigzag along u, whose mean is 1.5.
  scene.textures.emplace_back(2, 1, std::vector<Rgb>{grey(1), grey(2)});
  Mesh mesh = quad({-0.05f, 40, -0.05f}, {0.1f, 0, 0}, {0, 0, 0.1f}, light);
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene.meshes.push_back(mesh);
  check_lit(scene, ray({-1, 1, -2}, {0, 0, 0}), double{kRho} / kPiD * 1.5 * 0.01 / 1600, 1024);
}

TEST_CASE("Point, spot and directional lights follow their laws without noise") {
  Scene scene = floor_scene();
  const Ray r = ray({4, 1, 1}, {0, 0, 0});
  SECTION("point") {
    scene.lights.push_back(point_light({1, 2, 2}, 10));
    check_lit(scene, r, double{kRho} / kPiD * 10 / 9 * 2 / 3, 8);
  }
  SECTION("spot: full inside, half way, and dark outside") {
    Light spot = point_light({0, 2, 0}, 10);
    spot.kind = LightKind::spot;
    spot.cos_inner = 0.9f;
    spot.cos_outer = 0.7f;
    const double full = double{kRho} / kPiD * 10 / 4;
    for (const auto& [cosine, share] :
         {std::pair{0.95, 1.0}, {0.8, 0.5}, {0.75, 0.15625}, {0.69, 0.0}}) {
      const double sine = std::sqrt(1 - cosine * cosine);
      spot.direction = Vec3(static_cast<float>(sine), static_cast<float>(-cosine), 0);
      scene.lights = {spot};
      check_lit(scene, r, full * share, 8);
    }
  }
  SECTION("directional, without and with an angle") {
    Light sun;
    sun.kind = LightKind::directional;
    sun.direction = Vec3(-3, -4, 0).normalized();
    sun.intensity = grey(2);
    for (const float angle : {0.0f, 0.00465f, 0.4f}) {
      sun.angle = angle;
      scene.lights = {sun};
      check_lit(scene, r, double{kRho} / kPiD * 2 * 0.8, 1024);
    }
  }
  SECTION("forty lights: one is chosen, and the mean is the sum") {
    double expected = 0;
    for (int k = 0; k < 40; ++k) {
      const double x = 0.1 * k - 2, intensity = 0.5 + 0.02 * k;
      scene.lights.push_back(
          point_light({static_cast<float>(x), 2, 0}, static_cast<float>(intensity)));
      expected += intensity / (x * x + 4) * 2 / std::sqrt(x * x + 4);
    }
    check_lit(scene, r, double{kRho} / kPiD * expected, 2048);
  }
}

TEST_CASE("A constant sky gives rho L, and L where nothing is hit") {
  Scene scene = floor_scene();
  scene.environment.radiance = grey(3);
  check_lit(scene, ray({4, 1, 1}, {0, 0, 0}), double{kRho} * 3, 16);
  check_lit(scene, ray({4, 1, 1}, {5, 2, 0}), 3, 4);
}

namespace {

// The map as documented, in double and by itself: texel centres, bilinear, u around, v clamped.
double map_at(const std::vector<Rgb>& texels, int width, int height, double x, double y, double z) {
  const double u = (0.5 + std::atan2(x, -z) / (2 * kPiD)) * width - 0.5;
  const double v = std::clamp(std::acos(y) / kPiD * height - 0.5, 0.0, height - 1.0);
  const double fu = u - std::floor(u), fv = v - std::floor(v);
  double sum = 0;
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const int px = (static_cast<int>(std::floor(u)) + dx + width) % width;
      const int py = std::min(static_cast<int>(v) + dy, height - 1);
      sum += double{texels[static_cast<std::size_t>(py * width + px)].y} * (dx == 1 ? fu : 1 - fu) *
             (dy == 1 ? fv : 1 - fv);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("An environment map gives the integral of its lookup, also turned") {
  constexpr int kWidth = 16, kHeight = 8;
  std::mt19937 generator(21);
  std::uniform_real_distribution<float> uniform;
  std::vector<Rgb> texels;
  for (int k = 0; k < kWidth * kHeight; ++k) {
    const float v = uniform(generator);
    texels.push_back(grey(k % 5 == 0 ? 0 : v * v));
  }
  texels[2 * kWidth + 3] = grey(60);  // a small bright sun
  Scene scene;
  const int plane = add_material(scene, MaterialKind::diffuse, kRho);
  // A tilted plane: its normal is (1, 1, 1) / sqrt 3.
  const Vec3 n = Vec3(1, 1, 1).normalized(), s = Vec3(1, -1, 0).normalized(), t = cross(n, s);
  scene.meshes.push_back(quad((s + t) * -100.0f, s * 200.0f, t * 200.0f, plane));
  scene.textures.emplace_back(kWidth, kHeight, texels);
  scene.environment.radiance = grey(2);
  scene.environment.texture = 0;
  for (const float rotation : {0.0f, 1.1f}) {
    CAPTURE(rotation);
    scene.environment.rotation = rotation;
    const double c = std::cos(double{rotation}), d = std::sin(double{rotation});
    double irradiance = 0;
    constexpr int kSteps = 1200;
    for (int a = 0; a < kSteps; ++a) {
      const double y = 1 - (a + 0.5) * 2 / kSteps, r = std::sqrt(1 - y * y);
      for (int b = 0; b < kSteps; ++b) {
        const double phi = 2 * kPiD * (b + 0.5) / kSteps, x = r * std::cos(phi),
                     z = r * std::sin(phi);
        const double cosine = (x + y + z) / std::sqrt(3.0);
        // The map turned by `rotation` about +y: look up where the direction was before.
        if (cosine > 0)
          irradiance += cosine * map_at(texels, kWidth, kHeight, c * x - d * z, y, d * x + c * z);
      }
    }
    irradiance *= 2 * 4 * kPiD / (double{kSteps} * kSteps);
    check_lit(scene, ray(n * 3.0f + s, {0, 0, 0}), double{kRho} / kPiD * irradiance, 2048);
    // Seen directly.
    const auto integrator = make(scene, "path");
    for (int k = 0; k < 200; ++k) {
      Vec3 w(uniform(generator) - 0.5f, uniform(generator) - 0.5f, uniform(generator) - 0.5f);
      w.normalize();
      if (dot(w, n) < 0.01f) w = -w;
      if (dot(w, n) < 0.01f) continue;
      const PathRecord record = trace(*integrator, {n, w}, SamplerKind::sobol, 0, 0);
      CHECK_FALSE(record.has_vertex);
      CHECK(double{record.unfiltered.y} ==
            Approx(2 * map_at(texels, kWidth, kHeight, c * double{w.x} - d * double{w.z},
                              double{w.y}, d * double{w.x} + c * double{w.z}))
                .epsilon(1e-3)
                .margin(1e-4));
    }
  }
}

TEST_CASE("Ambient occlusion beside a wall is one minus its form factor") {
  Scene scene = floor_scene();
  // An endless wall of height 1, at distance 0.8 from the origin.
  scene.meshes.push_back(quad({-1000, 0, -0.8f}, {2000, 0, 0}, {0, 1, 0}, 0));
  const double open = 1 - 0.5 * (1 - 0.8 / std::sqrt(1.64));
  const Ray r = ray({0.5f, 1, 2}, {0, 0, 0});
  const auto integrator = make(scene, "ao");
  for (const SamplerKind kind : kKinds) check(estimate(*integrator, r, kind, 2048), open);
  SECTION("with a reach that ends before the wall, nothing occludes") {
    IntegratorSettings settings;
    settings.name = "ao";
    settings.ao_distance = 0.75f;
    check(estimate(*make_integrator(scene, settings), r, SamplerKind::sobol, 64), 1);
  }
}

TEST_CASE("Light of one bounce between a floor and a glowing wall, by the double integral") {
  // c at the floor's origin of what a diffuse ceiling of infinite extent reflects of a constant
  // irradiance: the ceiling at height 1, lit by the floor's own emission e, has radiance rho e; all
  // directions see it.
  Scene scene;
  const int floor = add_material(scene, MaterialKind::diffuse, 0.5f, 1);
  const int ceiling = add_material(scene, MaterialKind::diffuse, 0.8f);
  scene.meshes.push_back(make_floor(floor));
  scene.meshes.push_back(quad({-1000, 1, -1000}, {2000, 0, 0}, {0, 0, 2000}, ceiling));
  const Ray r = ray({0.5f, 0.5f, 0.2f}, {0, 0, 0});
  // Emission + rho_floor (rho_ceiling e): depth 2 is the first bounce, the geometric series its
  // limit.
  for (const auto& [depth, expected] :
       {std::pair{1, 1.0}, {2, 1.4}, {4, 1 + 0.4 * 1.4}, {1000, 1 / 0.6}}) {
    CAPTURE(depth);
    const auto integrator = make(scene, "path", depth);
    for (const SamplerKind kind : kKinds) check(estimate(*integrator, r, kind, 1024), expected);
  }
}
