// Each weight term decides as the design's table says, and can only shrink the set.
#include "filter/weights.h"

#include <limits>

#include "catch.h"
#include "filter/estimate.h"
#include "filter/radius.h"
#include "record_set.h"

namespace psf {
namespace {

constexpr float kMiss = std::numeric_limits<float>::infinity();
const std::vector<filter::CameraView> kWeightsCamera = {{20, 20, 0.05}};

TEST_CASE("Thresholds belong to the set that passes") {
  CHECK(filter::normal_term({1, 0, 0}, {0.5f, 1, 0}, 0.5f));
  CHECK_FALSE(filter::normal_term({1, 0, 0}, {0.499f, 1, 0}, 0.5f));
  CHECK(filter::reflectance_term(Rgb(0.75f, 0, 0), Rgb(0.25f, 0, 0), 0.25f));
  CHECK_FALSE(filter::reflectance_term(Rgb(0.75f, 0, 0.01f), Rgb(0.25f, 0, 0), 0.25f));
  CHECK(filter::plane_term({0, 0, 0}, {0, 1, 0}, {5, -0.5f, 7}, 0.25f, 2));
  CHECK_FALSE(filter::plane_term({0, 0, 0}, {0, 1, 0}, {0, -0.51f, 0}, 0.25f, 2));
  CHECK(filter::direction_term({0, 0, 1}, {0, 1, 0.5f}, 0.5f));
  CHECK_FALSE(filter::direction_term({0, 0, 1}, {0, 0, -1}, 0));
  CHECK(filter::visibility_term(5, 5));
  CHECK_FALSE(filter::visibility_term(5, 4));
  CHECK(filter::material_term(0, 0));
  CHECK_FALSE(filter::material_term(0, 1));
  // 0.35 and 10 times 0.12 are the legs of 1.25.
  const Vec3 n_j(0.35f, 0, 0), omega_j(0, 0.12f, 0), zero(0, 0, 0);
  CHECK(filter::gloss_term(zero, n_j, zero, omega_j, 0.5f, 2.5001f));
  CHECK_FALSE(filter::gloss_term(zero, n_j, zero, omega_j, 0.5f, 2.4999f));
}

TEST_CASE("Hit distances compare relative to the longer, misses only to misses") {
  CHECK(filter::hit_distance_term(1, 0.5f, 0.5f));
  CHECK(filter::hit_distance_term(0.5f, 1, 0.5f));
  CHECK_FALSE(filter::hit_distance_term(1, 0.49f, 0.5f));
  CHECK(filter::hit_distance_term(kMiss, kMiss, 0));
  CHECK_FALSE(filter::hit_distance_term(kMiss, 1, 100));
  CHECK_FALSE(filter::hit_distance_term(1, kMiss, 100));
  CHECK(filter::hit_distance_term(0, 0, 0));
}

TEST_CASE("Refusers are empty exactly where the product passes") {
  const tests::RecordSet set = tests::random_records(400, 1, 0, kWeightsCamera);
  filter::WeightTerms terms{0.9f, 0.05f, true, 0.5f, 0.4f, 0.5f, true, 6.0f};
  const filter::Weights weights(set.view(), terms);
  std::size_t passed = 0, wrong = 0;
  for (std::uint32_t i = 0; i < 400; ++i) {
    for (std::uint32_t j = 0; j < 400; ++j) {
      const bool pass = weights.pass(i, j, 0.5f);
      wrong += pass != (weights.refusers(i, j, 0.5f) == 0) ? 1u : 0u;
      passed += pass ? 1u : 0u;
    }
  }
  CHECK(wrong == 0);
  CHECK(passed > 800);
}

TEST_CASE("Each term more can only shrink the set of every record") {
  const tests::RecordSet set = tests::random_records(400, 2, 0, kWeightsCamera);
  const filter::Block block{0, 1, 1, kWeightsCamera};
  filter::Parameters parameters;
  parameters.radius = {0.3, filter::RadiusBasis::distance};
  std::vector<float> radius;
  filter::radii(parameters.radius, set.view(), block, radius);
  const filter::WeightTerms all{0.93f, 0.05f, true, 0.3f, 0.4f, 0.93f, true, 6.0f};
  const auto neighbors = [&](unsigned bits) {
    filter::WeightTerms& w = parameters.weights = filter::WeightTerms::none();
    if ((bits & 1) != 0) w.normal = all.normal;
    if ((bits & 2) != 0) w.reflectance = all.reflectance;
    w.visibility = (bits & 4) != 0;
    if ((bits & 8) != 0) w.hit_distance = all.hit_distance;
    if ((bits & 16) != 0) w.plane = all.plane;
    if ((bits & 32) != 0) w.direction = all.direction;
    w.material = (bits & 64) != 0;
    if ((bits & 128) != 0) w.gloss = all.gloss;
    return filter::estimate(set.view(), radius, block, parameters).neighbors;
  };
  for (unsigned term = 1; term < 256; term *= 2) {
    std::size_t grew = 0, shrank = 0;
    for (const unsigned others : {0u, 1u, 2u, 12u, 255u}) {
      const auto without = neighbors(others & ~term), with = neighbors(others | term);
      for (std::size_t i = 0; i < set.size(); ++i) {
        grew += with[i] > without[i] ? 1u : 0u;
        shrank += with[i] < without[i] ? 1u : 0u;
      }
    }
    INFO("term " << term);
    CHECK(grew == 0);
    CHECK(shrank > 100);
  }
}

TEST_CASE("A term whose channel is missing is an error that names both") {
  tests::RecordSet set(3);
  set.visibility.clear();
  filter::Parameters parameters;
  parameters.weights.visibility = true;
  const filter::Records records = {
      set.flags,        set.position,    set.distance, set.throughput,
      set.contribution, set.unfiltered,  set.pixel,    set.camera,
      set.normal,       set.reflectance, {},           set.hit_distance,
      set.direction,    set.material,    set.roughness};
  const filter::Block block{0, 1, 1, kWeightsCamera};
  CHECK_THROWS_WITH(filter::estimate(records, std::vector<float>(3, 1.0f), block, parameters),
                    "the records have no channel visibility, which `visibility` needs");
}

}  // namespace
}  // namespace psf
