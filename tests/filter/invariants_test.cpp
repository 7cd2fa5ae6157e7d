// What is always true of the filter, whatever the records.
#include <cstring>

#include "catch.h"
#include "core/parallel.h"
#include "filter/average.h"
#include "run_average.h"

namespace psf {
namespace {

using filter::Average;
using filter::Parameters;
using tests::RecordSet;

bool same_bytes(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

TEST_CASE("r0 = 0 gives every contribution back, bit for bit") {
  RecordSet set = tests::random_records(900, 1, 0, tests::kCamera);
  set.contribution[4] = Rgb(-0.0f, 1e-42f, 3e38f);
  for (const bool demodulate : {false, true}) {
    for (const auto estimator : {filter::Estimator::average, filter::Estimator::disk}) {
      for (const std::uint32_t iterations : {1u, 3u}) {
        Parameters parameters;
        parameters.radius = {0, filter::RadiusBasis::distance};
        parameters.demodulate = demodulate;
        parameters.estimator = estimator;
        parameters.iterations = iterations;
        const Average result = tests::run_average(set, parameters);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < set.size(); ++i) {
          if (result.roles[i] != filter::Role::source) continue;
          wrong += std::memcmp(&result.c_bar[i], &set.contribution[i], sizeof(Rgb)) != 0 ? 1u : 0u;
        }
        CHECK(wrong == 0);
        CHECK(result.statistics.sources > 700);
      }
    }
  }
}

TEST_CASE("Constant c gives c_bar = c exactly, unshaded records and orphans too") {
  RecordSet set = tests::random_records(900, 2, 0.5, tests::kCamera);
  const Rgb c(0.1f, 7, 1e-30f);
  for (std::size_t i = 0; i < set.size(); ++i)
    set.contribution[i] = set.flags[i] == 3 ? c : Rgb(99);
  for (const double r0 : {0.0, 0.01, 0.2, 5.0}) {
    Parameters parameters;
    parameters.radius = {r0, filter::RadiusBasis::distance};
    parameters.iterations = 2;
    const Average result = tests::run_average(set, parameters);
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (set.flags[i] != 0) REQUIRE(result.c_bar[i] == c);
    }
  }
}

TEST_CASE("A ball that holds the block, without weights, gives the block's mean") {
  const RecordSet set = tests::random_records(900, 3, 0.1, tests::kCamera);
  Parameters parameters;
  parameters.radius = {10, filter::RadiusBasis::world, 0.5, {}};
  parameters.weights = filter::WeightTerms::none();
  const Average result = tests::run_average(set, parameters, 4);
  double mean[3] = {}, count = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.flags[i] != 3) continue;
    for (int k = 0; k < 3; ++k) mean[k] += double{set.contribution[i][k]};
    ++count;
  }
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.flags[i] == 0) continue;
    for (int k = 0; k < 3; ++k) REQUIRE(result.c_bar[i][k] == static_cast<float>(mean[k] / count));
  }
}

TEST_CASE("The same bytes for any number of threads") {
  const RecordSet set = tests::random_records(5000, 4, 0.3, tests::kCamera);
  Parameters parameters;
  parameters.radius = {0.1, filter::RadiusBasis::distance};
  parameters.iterations = 2;
  parameters.demodulate = true;
  parameters.count_refusals = true;
  const auto with_threads = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    return tests::run_average(set, parameters);
  };
  const Average one = with_threads(1);
  for (const std::size_t threads : {2u, 4u}) {
    const Average many = with_threads(threads);
    CHECK(same_bytes(one.c_bar, many.c_bar));
    CHECK(one.neighbors == many.neighbors);
    CHECK(one.statistics.candidates == many.statistics.candidates);
    CHECK(one.statistics.refused == many.statistics.refused);
  }
}

// Two sheets of records in the plane of the first two axes given, at the origin and far along
// `offset`.
RecordSet two_sheets(const Vec3& normal_a, const Vec3& normal_b, const Vec3& u, const Vec3& v,
                     const Vec3& offset) {
  RecordSet set(2 * 20 * 20);
  for (std::size_t k = 0; k < set.size(); ++k) {
    const bool second = k >= 400;
    const float s = static_cast<float>(k % 20) / 20, t = static_cast<float>(k % 400 / 20) / 20;
    set.position[k] = second ? offset + v * s + u * t : Vec3(1, 0, 0) * s + Vec3(0, 0, 1) * t;
    set.normal[k] = second ? normal_b : normal_a;
    set.contribution[k] = second ? Rgb(0) : Rgb(100);
  }
  return set;
}

TEST_CASE("With default weights nothing crosses a thin wall") {
  const RecordSet set = two_sheets({0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}, {0, -1e-4f, 0});
  Parameters parameters;
  parameters.radius = {0.3, filter::RadiusBasis::distance};
  parameters.iterations = 3;
  parameters.count_refusals = true;
  const Average result = tests::run_average(set, parameters);
  for (std::size_t i = 0; i < set.size(); ++i) REQUIRE(result.c_bar[i] == set.contribution[i]);
  CHECK(result.statistics.mean_neighbors() > 20);
  CHECK(result.statistics.candidates > result.statistics.accepted);
  parameters.weights = filter::WeightTerms::none();
  CHECK(tests::run_average(set, parameters).c_bar[400].x > 10);
}

TEST_CASE("With default weights nothing crosses a 90 degree edge") {
  const RecordSet set = two_sheets({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 0});
  Parameters parameters;
  parameters.radius = {0.3, filter::RadiusBasis::distance};
  const Average result = tests::run_average(set, parameters);
  for (std::size_t i = 0; i < set.size(); ++i) REQUIRE(result.c_bar[i] == set.contribution[i]);
  parameters.weights = filter::WeightTerms::none();
  CHECK(tests::run_average(set, parameters).c_bar[400].x > 10);
}

TEST_CASE("Demodulated, a texture stays sharp under a constant light") {
  RecordSet set = tests::random_records(900, 5, 0, tests::kCamera);
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.reflectance[i].y = 0.1f + 0.001f * static_cast<float>(i);
    set.contribution[i] = set.reflectance[i] * 3.0f;
  }
  Parameters parameters;
  parameters.radius = {1, filter::RadiusBasis::distance};
  parameters.weights = filter::WeightTerms::none();
  parameters.demodulate = true;
  const Average result = tests::run_average(set, parameters);
  // Green, whose reflectance is nowhere 0.
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.flags[i] != 0)
      REQUIRE(result.c_bar[i].y == Approx(set.contribution[i].y).epsilon(1e-6));
  }
}

TEST_CASE("No records, no result; one record keeps its own") {
  CHECK(tests::run_average(RecordSet(0), {}).c_bar.empty());
  const RecordSet one(1);
  CHECK(tests::run_average(one, {}).c_bar[0] == one.contribution[0]);
}

}  // namespace
}  // namespace psf
