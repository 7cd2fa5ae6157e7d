// [average] and its kin agree with a second writing of the equations.
#include "catch.h"
#include "filter/estimate.h"
#include "filter/radius.h"
#include "oracle.h"

namespace psf {
namespace {

using filter::Parameters;
using tests::RecordSet;

const std::vector<filter::CameraView> kOneCamera = {{16, 10, 0.04}};
const std::vector<filter::CameraView> kTwoCameras = {{16, 5, 0.04}, {8, 9, 0.08}};

struct Case {
  Parameters parameters;
  std::vector<filter::CameraView> cameras = kOneCamera;
  double n = 3;
  std::uint64_t first_path = 320;
  double samples_per_pixel = 1.5;
  double share_unshaded = 0;
  std::size_t count = 240;
};

bool near(float value, double expected) {
  return std::abs(double{value} - expected) <= 3e-6 * (std::abs(expected) + 1e-3);
}

// Returns how many neighbours there were.
std::size_t check_case(const Case& c, std::uint32_t seed) {
  RecordSet set = tests::random_records(c.count, seed, c.share_unshaded, c.cameras);
  Parameters parameters = c.parameters;
  parameters.count_refusals = true;
  parameters.validate();
  const filter::Block block{c.first_path, c.n, c.samples_per_pixel, c.cameras};
  std::vector<float> radius;
  filter::radii(parameters.radius, set.view(), block, radius);
  const filter::Estimates got = filter::estimate(set.view(), radius, block, parameters);
  const tests::OracleResult expected =
      tests::Oracle(set, parameters, c.cameras, c.n, c.first_path, c.samples_per_pixel)
          .run(0, set.size());

  std::size_t wrong = 0, neighbors = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const bool averaged =
        got.roles[i] == filter::Role::source || got.roles[i] == filter::Role::query;
    wrong += averaged != expected.has_average[i] ? 1u : 0u;
    if (!averaged) continue;
    wrong += near(radius[i], expected.radius[i]) ? 0u : 1u;
    wrong += got.neighbors[i] != expected.neighbors[i] ? 1u : 0u;
    for (int k = 0; k < 3; ++k) {
      wrong += near(got.c_bar[i][k], expected.c_bar[i][static_cast<std::size_t>(k)]) ? 0u : 1u;
    }
    neighbors += expected.neighbors[i];
  }
  CHECK(wrong == 0);
  CHECK(got.statistics.candidates == expected.candidates);
  CHECK(got.statistics.accepted == neighbors);
  CHECK(got.statistics.orphans == expected.orphans);
  CHECK(got.statistics.orphans_unmatched == expected.unmatched);
  for (std::size_t k = 0; k < filter::kTermCount; ++k) {
    CHECK(got.statistics.refused[k] == expected.refused[k]);
  }
  return neighbors;
}

Case plain_case() {
  Case c;
  c.parameters.radius = {0.3, filter::RadiusBasis::distance};
  c.parameters.weights = tests::terms_of(3);
  return c;
}

TEST_CASE("Every subset of weight terms agrees with the oracle") {
  for (unsigned bits = 0; bits < 256; ++bits) {
    Case c = plain_case();
    c.parameters.weights = tests::terms_of(bits);
    c.share_unshaded = bits % 2 == 0 ? 0.5 : 0;
    INFO("terms " << bits);
    CHECK(check_case(c, bits) > c.count / 3);
  }
}

TEST_CASE("Each basis of the radius agrees with the oracle, over n and delta") {
  for (const double n : {1.0, 2.5, 64.0}) {
    for (const double delta : {0.0, 1.0 / 3, 0.9}) {
      for (const auto basis : {filter::RadiusBasis::distance, filter::RadiusBasis::footprint,
                               filter::RadiusBasis::world}) {
        Case c = plain_case();
        c.n = n;
        c.cameras = kTwoCameras;
        c.parameters.radius = {
            basis == filter::RadiusBasis::footprint ? 6.0 : 0.35, basis, delta, {}};
        INFO("n " << n << ", delta " << delta << ", basis " << static_cast<int>(basis));
        check_case(c, 7);
      }
    }
  }
}

TEST_CASE("Iterations, demodulation and both together agree with the oracle") {
  for (const std::uint32_t iterations : {1u, 2u, 5u}) {
    for (const bool demodulate : {false, true}) {
      Case c = plain_case();
      c.parameters.iterations = iterations;
      c.parameters.demodulate = demodulate;
      c.share_unshaded = 0.2;
      INFO("iterations " << iterations << ", demodulate " << demodulate);
      check_case(c, 8);
    }
  }
}

TEST_CASE("Subsampled and unshaded records agree with the oracle, orphans too") {
  for (const std::uint32_t sources : {1u, 2u, 4u, 7u, 100u}) {
    for (const double r0 : {0.0, 0.05, 0.3}) {
      Case c = plain_case();
      c.parameters.sources = sources;
      c.parameters.radius = {r0, filter::RadiusBasis::distance};
      c.parameters.weights = tests::terms_of(1 + 4 + 8 + 64);
      c.cameras = kTwoCameras;
      c.share_unshaded = 0.3;
      INFO("sources 1/" << sources << ", r0 " << r0);
      check_case(c, 9);
    }
  }
}

TEST_CASE("Orphans far from any source that passes agree with the oracle") {
  Case c = plain_case();
  c.count = 3000;
  c.parameters.radius = {0.01, filter::RadiusBasis::distance};
  c.parameters.weights = tests::terms_of(255);
  c.share_unshaded = 0.6;
  check_case(c, 10);
}

TEST_CASE("The disk estimator agrees with the oracle") {
  for (const double r0 : {0.0, 0.05, 0.4}) {
    Case c = plain_case();
    c.parameters.estimator = filter::Estimator::disk;
    c.parameters.radius = {r0, filter::RadiusBasis::distance};
    c.share_unshaded = 0.3;
    check_case(c, 11);
    c.parameters.iterations = 2;
    c.parameters.demodulate = true;
    check_case(c, 12);
  }
}

TEST_CASE("Brute force and FLANN give the same neighbours of every record") {
  Case c = plain_case();
  RecordSet set = tests::random_records(2000, 13, 0.2, kOneCamera);
  const filter::Block block{0, 1, 1, kOneCamera};
  std::vector<float> radius;
  filter::radii(c.parameters.radius, set.view(), block, radius);
  c.parameters.count_refusals = true;
  const filter::Estimates plain = filter::estimate(set.view(), radius, block, c.parameters);
  c.parameters.engine = filter::EngineKind::brute;
  const filter::Estimates brute = filter::estimate(set.view(), radius, block, c.parameters);
  CHECK(plain.neighbors == brute.neighbors);
  CHECK(plain.statistics.candidates == brute.statistics.candidates);
  CHECK(plain.statistics.refused == brute.statistics.refused);
}

}  // namespace
}  // namespace psf
