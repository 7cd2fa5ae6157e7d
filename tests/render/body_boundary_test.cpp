// The boundary of bodies: samples of a rough one follow their density, and sampled light leaves
// through what lets it out alone.
#include <functional>
#include <random>
#include <vector>

#include "body_scenes.h"
#include "render/light/bsdf.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

Vec3 toward(double cosine, double phi) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return Vec3(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
              static_cast<float>(cosine));
}

// The integral of a boundary's density over the directions outside between two cosines.
double leaves_between(const Bsdf& bsdf, const Vec3& o, double z0, double z1) {
  constexpr int kZ = 200, kPhi = 400;
  double sum = 0;
  for (int a = 0; a < kZ; ++a) {
    for (int b = 0; b < kPhi; ++b) {
      float pdf = 0;
      static_cast<void>(bsdf.evaluate(
          o, toward(z0 + (z1 - z0) * (a + 0.5) / kZ, 2 * kPiD * (b + 0.5) / kPhi), pdf));
      sum += double{pdf};
    }
  }
  return sum * (z1 - z0) / kZ * 2 * kPiD / kPhi;
}

// Of the sides in the order of add_room().
constexpr std::size_t kRight = 3;

// A cube of a body on whose right a lamp stands, so that a straight way there leaves by its right
// side, which has another material. Returns what its top shows.
double seen_of_lamp(const Body& body, bool point, const std::function<int(Scene&, int)>& right) {
  Scene scene;
  const int wax = add_body(scene, body);
  std::vector<int> sides(6, wax);
  sides[kRight] = right(scene, wax);
  add_room(scene, sides);
  // Those of a room face inward.
  for (Mesh& side : scene.meshes) {
    for (auto& [a, b, c] : side.triangles) std::swap(b, c);
  }
  if (point) {
    scene.lights.push_back(point_light({9, 0, 0}, 100));
  } else {
    const int lamp = add_material(scene, MaterialKind::diffuse, 0, 50);
    scene.spheres.push_back({"", Vec3(9, 0, 0), 1, lamp});
  }
  return estimate(*make(scene, "path", 64), ray({0.2f, 3, 0.1f}, {0.3f, 0, 0}), SamplerKind::sobol,
                  256, 4)
      .mean;
}

int with_ior(Scene& scene, int wax, float ior) {
  Material other = scene.materials[static_cast<std::size_t>(wax)];
  other.ior = ior;
  scene.materials.push_back(other);
  return static_cast<int>(scene.materials.size()) - 1;
}

}  // namespace

TEST_CASE("What leaves a rough boundary follows the density of its samples") {
  std::mt19937 generator(17);
  std::uniform_real_distribution<float> uniform;
  for (const float ior : {1.2f, 1.5f}) {
    for (const float roughness : {0.4f, 0.8f}) {
      Material material;
      material.kind = MaterialKind::subsurface;
      material.ior = ior;
      material.roughness = roughness;
      const Bsdf bsdf = Bsdf::of_boundary(material);
      for (const double cosine : {0.95, 0.7}) {
        const Vec3 o = toward(-cosine, 0.4);
        constexpr int kBins = 5, kSamples = 200'000;
        std::vector<double> found(kBins);
        for (int k = 0; k < kSamples; ++k) {
          const Vec2 u{uniform(generator), uniform(generator)};
          BsdfSample s;
          if (!bsdf.sample(o, u, uniform(generator), s) || s.inside) continue;
          REQUIRE(s.direction.z > 0);
          ++found[static_cast<std::size_t>(
              std::min(kBins - 1, static_cast<int>(s.direction.z * kBins)))];
        }
        double left = 0;
        for (int b = 0; b < kBins; ++b) {
          const double expected =
              leaves_between(bsdf, o, b / double{kBins}, (b + 1) / double{kBins}) * kSamples;
          CAPTURE(ior, roughness, cosine, b, expected, found[static_cast<std::size_t>(b)]);
          CHECK(std::abs(found[static_cast<std::size_t>(b)] - expected) <
                5 * std::sqrt(expected + 10) + 0.005 * expected);
          left += expected;
        }
        CHECK(left > 0.2 * kSamples);
      }
    }
  }
}

TEST_CASE("Sampled light leaves a body by a boundary that does not refract, and by nothing else") {
  const Body body{.albedo = 0.9f, .sigma_t = 0.5f};
  for (const bool point : {true, false}) {
    CAPTURE(point);
    const double same = seen_of_lamp(body, point, [](Scene&, int wax) { return wax; });
    CHECK(same > 0.01);
    CHECK(seen_of_lamp(body, point, [](Scene& scene, int wax) {
            return with_ior(scene, wax, 1);
          }) == Approx(same));
    CHECK(seen_of_lamp(body, point, [](Scene& scene, int) {
            return add_material(scene, MaterialKind::diffuse, 0);
          }) == 0);
    CHECK(seen_of_lamp(body, point, [](Scene& scene, int) {
            return add_body(scene, {.albedo = 0.9f, .sigma_t = 0.5f});
          }) == 0);
  }
  // A smooth one that refracts bends the way: a lamp without extent is never found behind it.
  const auto refracting = [](Scene& scene, int wax) { return with_ior(scene, wax, 1.4f); };
  CHECK(seen_of_lamp(body, true, refracting) == 0);
  CHECK(seen_of_lamp(body, false, refracting) > 0.001);
}
