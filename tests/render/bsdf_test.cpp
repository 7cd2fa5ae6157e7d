// Scattering: samples follow their density, densities integrate to one, energy and reciprocity
// hold.
#include "render/light/bsdf.h"

#include <random>

#include "analytic_support.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

struct Case {
  const char* name;
  MaterialKind kind;
  float reflectance, roughness, metalness;
  bool many_bounces = false;
  float clear = 0, clear_roughness = 0;
};

const Case kCases[] = {
    {"diffuse", MaterialKind::diffuse, 0.8f, 0, 0},
    {"smooth conductor", MaterialKind::conductor, 0.9f, 0.2f, 0},
    {"conductor", MaterialKind::conductor, 1, 0.5f, 0},
    {"rough conductor", MaterialKind::conductor, 1, 1, 0},
    {"smooth coat", MaterialKind::coat, 1, 0.2f, 0},
    {"coat", MaterialKind::coat, 1, 0.5f, 0},
    {"rough coat", MaterialKind::coat, 1, 1, 0},
    {"metallic coat", MaterialKind::coat, 1, 0.4f, 0.6f},
    {"smooth metal", MaterialKind::conductor, 1, 0.2f, 0, true},
    {"metal", MaterialKind::conductor, 1, 0.55f, 0, true},
    {"rough metal", MaterialKind::conductor, 1, 1, 0, true},
    {"rough dark metal", MaterialKind::conductor, 0.4f, 0.9f, 0, true},
    {"half metal", MaterialKind::coat, 1, 0.8f, 0.6f, true},
    {"smooth gloss", MaterialKind::gloss, 1, 0.2f, 0},
    {"rough gloss", MaterialKind::gloss, 1, 0.7f, 0},
    {"coat under a clear coat", MaterialKind::coat, 1, 0.5f, 0, false, 1, 0.3f},
    {"metal under half a clear coat", MaterialKind::coat, 0.9f, 0.4f, 1, true, 0.5f, 0.25f},
    {"smooth metal under a rough one", MaterialKind::coat, 1, 0.25f, 1, false, 1, 0.6f},
};

struct Fixture {
  explicit Fixture(const Case& c) : many_bounces(c.many_bounces) {
    const int index = add_material(scene, c.kind, c.reflectance);
    Material& m = scene.materials[static_cast<std::size_t>(index)];
    m.roughness = c.roughness;
    m.metalness = c.metalness;
    m.specular = Rgb(0.7f, 0.3f, 0.05f);
    m.clearcoat = c.clear;
    m.clearcoat_roughness = c.clear_roughness;
  }
  [[nodiscard]] Bsdf bsdf(bool front = true) const {
    static const CoatAlbedo table(1.5f), schlick = CoatAlbedo::schlick(),
                                         white = CoatAlbedo::white();
    const Material& m = scene.materials[0];
    return Bsdf(m, scene, {0, 0}, front, m.kind == MaterialKind::gloss ? &schlick : &table,
                many_bounces ? &white : nullptr, &table);
  }
  Scene scene;
  bool many_bounces;
};

Vec3 direction(double cosine, double phi) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return Vec3(static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
              static_cast<float>(cosine));
}

// Integrals over a box in (cosine, phi) of the density and of f cos.
struct Integral {
  double pdf = 0, energy = 0;
};
Integral integrate(const Bsdf& bsdf, const Vec3& o, double z0, double z1, double phi0, double phi1,
                   int steps) {
  Integral sum;
  for (int a = 0; a < steps; ++a) {
    for (int b = 0; b < steps; ++b) {
      float pdf;
      const Rgb f = bsdf.evaluate(
          o,
          direction(z0 + (z1 - z0) * (a + 0.5) / steps, phi0 + (phi1 - phi0) * (b + 0.5) / steps),
          pdf);
      sum.pdf += double{pdf};
      sum.energy += double{f.y};
    }
  }
  const double area = (z1 - z0) * (phi1 - phi0) / (steps * steps);
  return {sum.pdf * area, sum.energy * area};
}

}  // namespace

TEST_CASE("Samples of every material follow the density, and its lost part is what is absorbed") {
  std::mt19937 generator(11);
  std::uniform_real_distribution<float> uniform;
  for (const Case& c : kCases) {
    const Fixture fixture(c);
    const Bsdf bsdf = fixture.bsdf();
    for (const double cosine : {0.95, 0.5, 0.2}) {
      CAPTURE(c.name, cosine);
      const Vec3 o = direction(cosine, 0.3);
      constexpr int kZ = 8, kPhi = 12, kSamples = 60000;
      std::vector<double> found(kZ * kPhi + 1), expected(kZ * kPhi + 1);
      double energy_sum = 0, energy_sum_sq = 0;
      for (int k = 0; k < kSamples; ++k) {
        BsdfSample s;
        const Vec2 u{uniform(generator), uniform(generator)};  // braces: in this order everywhere
        if (!bsdf.sample(o, u, uniform(generator), s) || s.direction.z <= 0) {
          ++found.back();
          continue;
        }
        const double phi = std::atan2(double{s.direction.y}, double{s.direction.x}) + kPiD;
        const int z = std::min(kZ - 1, static_cast<int>(double{s.direction.z} * kZ));
        const int p = std::min(kPhi - 1, static_cast<int>(phi / (2 * kPiD) * kPhi));
        ++found[static_cast<std::size_t>(z * kPhi + p)];
        energy_sum += double{s.weight.y};
        energy_sum_sq += double{s.weight.y} * double{s.weight.y};
      }
      Integral total;
      for (int z = 0; z < kZ; ++z) {
        for (int p = 0; p < kPhi; ++p) {
          const Integral part =
              integrate(bsdf, o, z / double{kZ}, (z + 1) / double{kZ}, 2 * kPiD * p / kPhi - kPiD,
                        2 * kPiD * (p + 1) / kPhi - kPiD, 80);
          expected[static_cast<std::size_t>(z * kPhi + p)] = part.pdf * kSamples;
          total.pdf += part.pdf;
          total.energy += part.energy;
        }
      }
      CHECK(total.pdf < 1.001);
      expected.back() = std::max(0.0, 1 - total.pdf) * kSamples;
      if (c.roughness <= 0.2f && cosine > 0.4) CHECK(total.pdf > 0.997);
      double chi_sq = 0, pooled_found = 0, pooled_expected = 0;
      int bins = 0;
      for (std::size_t b = 0; b < found.size(); ++b) {
        if (expected[b] < 20) {
          pooled_found += found[b];
          pooled_expected += expected[b];
          continue;
        }
        chi_sq += (found[b] - expected[b]) * (found[b] - expected[b]) / expected[b];
        ++bins;
      }
      CHECK(std::abs(pooled_found - pooled_expected) < 5 * std::sqrt(pooled_expected + 10) + 30);
      // Five standard deviations of chi squared.
      CHECK(chi_sq < bins + 5 * std::sqrt(2.0 * bins));
      const double mean = energy_sum / kSamples;
      const double error = std::sqrt((energy_sum_sq / kSamples - mean * mean) / kSamples);
      CHECK(std::abs(mean - total.energy) < 4 * error + 2e-3);
    }
  }
}

TEST_CASE("No material reflects more than it gets; a white coat loses nothing") {
  for (const Case& c : kCases) {
    const Fixture fixture(c);
    for (double cosine = 0.05; cosine < 1; cosine += 0.05) {
      CAPTURE(c.name, cosine);
      const double energy =
          // Narrow lobes at grazing angles need a fine grid.
          integrate(fixture.bsdf(), direction(cosine, 0), 0, 1, -kPiD, kPiD,
                    c.roughness == 0.2f && cosine < 0.45 ? 2000 : 300)
              .energy;
      CHECK(energy < 1.002);
      if (c.kind == MaterialKind::diffuse)
        CHECK(energy == Approx(double{c.reflectance}).epsilon(1e-4));
      const bool coated = c.kind == MaterialKind::coat || c.kind == MaterialKind::gloss;
      if (coated && c.metalness == 0 && c.clear == 0) CHECK(energy > 0.995);
      // What bounces between two coats is left out.
      if (coated && c.metalness == 0 && c.clear > 0) CHECK(energy > 0.88);
      if (c.many_bounces && c.reflectance == 1) CHECK(energy > 0.99);
      if (c.kind == MaterialKind::conductor && c.roughness < 0.3f && cosine > 0.3)
        CHECK(energy > 0.85);
    }
  }
}

TEST_CASE("White metal of any roughness reflects all that it gets, within 1%") {
  std::mt19937 generator(13);
  std::uniform_real_distribution<float> uniform;
  for (float roughness = 0; roughness <= 1; roughness += 1 / 13.0f) {  // off the table's grid
    const Fixture fixture({"", MaterialKind::conductor, 1, roughness, 0, true});
    const Bsdf bsdf = fixture.bsdf();
    for (const double cosine : {0.02, 0.05, 0.15, 0.35, 0.6, 0.8, 1.0}) {
      constexpr int kSamples = 100000;
      double sum = 0, sum_sq = 0;
      for (int k = 0; k < kSamples; ++k) {
        BsdfSample s;
        const Vec2 u{uniform(generator), uniform(generator)};
        if (!bsdf.sample(direction(cosine, 0.3), u, uniform(generator), s)) continue;
        if (s.direction.z <= 0) continue;
        sum += double{s.weight.y};
        sum_sq += double{s.weight.y} * double{s.weight.y};
      }
      const double energy = sum / kSamples;
      const double error = std::sqrt((sum_sq / kSamples - energy * energy) / kSamples);
      CAPTURE(roughness, cosine, energy, error);
      CHECK(error < 0.007);
      CHECK(std::abs(energy - 1) < std::max(0.01, 3 * error));
    }
  }
}

TEST_CASE("The rougher a coloured metal, the deeper its colour") {
  double before = 1;
  for (const float roughness : {0.1f, 0.4f, 0.7f, 1.0f}) {
    const Fixture fixture({"", MaterialKind::conductor, 0.5f, roughness, 0, true});
    const double energy =
        integrate(fixture.bsdf(), direction(0.9, 0), 0, 1, -kPiD, kPiD, 1500).energy;
    CAPTURE(roughness, energy, before);
    CHECK(energy < before);
    CHECK(energy > 0.25);
    before = energy + 1e-4;
  }
}

TEST_CASE("The roughest white conductor reflects 1 - ln 2 at normal incidence") {
  // D is 1 / pi there, and what is left after shadowing c / (1 + c) for the reflected cosine c.
  const Fixture fixture({"", MaterialKind::conductor, 1, 1, 0});
  const double energy = integrate(fixture.bsdf(), {0, 0, 1}, 0, 1, -kPiD, kPiD, 1000).energy;
  CHECK(energy == Approx(1 - std::log(2.0)).epsilon(1e-4));
}

TEST_CASE("Reflection is reciprocal") {
  std::mt19937 generator(12);
  std::uniform_real_distribution<float> uniform(0.02f, 1);
  for (const Case& c : kCases) {
    const Fixture fixture(c);
    const Bsdf bsdf = fixture.bsdf();
    for (int k = 0; k < 500; ++k) {
      const Vec3 a = direction(double{uniform(generator)}, 6.0 * double{uniform(generator)});
      const Vec3 b = direction(double{uniform(generator)}, 6.0 * double{uniform(generator)});
      float pdf;
      const float there = bsdf.evaluate(a, b, pdf).y / b.z, back = bsdf.evaluate(b, a, pdf).y / a.z;
      CHECK(there == Approx(back).epsilon(1e-3));
    }
  }
}

TEST_CASE("Glass splits by Fresnel, bends by Snell and scales radiance by the index squared") {
  Scene scene;
  add_material(scene, MaterialKind::glass, 0.9f);
  const bool front = GENERATE(true, false);
  const Bsdf bsdf(scene.materials[0], scene, {0, 0}, front, nullptr);
  const double eta = front ? 1.5 : 1 / 1.5;
  for (const double angle : {0.0, 0.3, 0.6, 1.2}) {
    CAPTURE(front, angle);
    const Vec3 o = direction(std::cos(angle), 0);
    int reflected = 0;
    constexpr int kSamples = 10000;
    for (int k = 0; k < kSamples; ++k) {
      BsdfSample s;
      REQUIRE(bsdf.sample(o, {0, 0}, (static_cast<float>(k) + 0.5f) / kSamples, s));
      CHECK(s.pdf == 0);
      if (s.direction.z > 0) {
        ++reflected;
        CHECK(s.weight.y == 1);
        CHECK(s.direction.x == -o.x);
        continue;
      }
      CHECK(double{s.direction.x} == Approx(-std::sin(angle) / eta).margin(1e-6));
      CHECK(double{s.weight.y} == Approx(0.9 / (eta * eta)).epsilon(1e-5));
    }
    // Fresnel's equations by the angles, from the law of sines and tangents.
    const double sine = std::sin(angle) / eta;
    double expected = 1;
    if (angle == 0) {
      expected = std::pow((eta - 1) / (eta + 1), 2);
    } else if (sine < 1) {
      const double t = std::asin(sine);
      const double rs = std::sin(angle - t) / std::sin(angle + t);
      const double rp = std::tan(angle - t) / std::tan(angle + t);
      expected = 0.5 * (rs * rs + rp * rp);
    }
    CHECK(reflected / double{kSamples} == Approx(expected).margin(1.01 / kSamples));
  }
}

TEST_CASE(
    "The back of a one-sided material reflects nothing, that of glass and of the others does") {
  for (const Case& c : kCases) {
    Fixture fixture(c);
    CHECK_FALSE(fixture.bsdf(false).black());
    fixture.scene.materials[0].two_sided = false;
    CHECK(fixture.bsdf(false).black());
    CHECK_FALSE(fixture.bsdf(true).black());
  }
}

TEST_CASE("A coat smoother than the threshold is two things, a rougher one is one") {
  const Fixture smooth({"", MaterialKind::coat, 0.5f, 0.1f, 0});
  CHECK(smooth.bsdf().straddles(0.3f));
  CHECK(Fixture({"", MaterialKind::coat, 0.5f, 0, 0}).bsdf().straddles(0));
  CHECK_FALSE(Fixture({"", MaterialKind::coat, 0.5f, 0.5f, 0}).bsdf().straddles(0.3f));
  CHECK_FALSE(Fixture({"", MaterialKind::coat, 0.5f, 0.1f, 1}).bsdf().straddles(0.3f));
  CHECK_FALSE(Fixture({"", MaterialKind::conductor, 0.5f, 0.1f, 0}).bsdf().straddles(0.3f));
  // The two lobes apart are the two lobes together.
  Bsdf diffuse = smooth.bsdf(), glossy = smooth.bsdf();
  diffuse.keep(Bsdf::kDiffuse);
  glossy.keep(Bsdf::kGlossy);
  CHECK(diffuse.roughness() == 1);
  CHECK(glossy.roughness() == 0.1f);
  CHECK(smooth.bsdf().roughness() == 1);
  // What the filter is told: how sharply the light of the lobes kept depends on the direction.
  CHECK(smooth.bsdf().least_roughness() == 0.1f);
  CHECK(diffuse.least_roughness() == 1);
  CHECK(glossy.least_roughness() == 0.1f);
  CHECK(Fixture({"", MaterialKind::diffuse, 0.5f, 0, 0}).bsdf().least_roughness() == 1);
  CHECK(Fixture({"", MaterialKind::conductor, 0.5f, 0.4f, 0}).bsdf().least_roughness() == 0.4f);
  CHECK(diffuse.albedo().y == 0.5f);
  CHECK(glossy.albedo().y == Approx(0.04).epsilon(1e-3));
  const Vec3 o = direction(0.7, 0), i = direction(0.72, 3.1);
  float pdf;
  CHECK(diffuse.evaluate(o, i, pdf).y + glossy.evaluate(o, i, pdf).y ==
        Approx(smooth.bsdf().evaluate(o, i, pdf).y));
}
