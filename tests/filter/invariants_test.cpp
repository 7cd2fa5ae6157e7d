// What is always true of the filter, whatever the records and the estimator.
#include <algorithm>
#include <cstring>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "estimator_case.h"

namespace psf {
namespace {

using filter::Estimates;
using filter::Estimator;
using tests::EstimatorRun;
using tests::name_of;
using tests::RecordSet;

RecordSet some_records(std::size_t count, std::uint32_t seed, double share_unshaded) {
  return tests::random_records(count, seed, share_unshaded, tests::kCamera);
}

bool takes(Estimator estimator, std::uint32_t iterations) {
  filter::Parameters parameters;
  parameters.estimator = estimator;
  parameters.iterations = iterations;
  try {
    parameters.validate();
  } catch (const Error&) {
    return false;
  }
  return true;
}

// The estimators, once and three times over where they can be.
std::vector<EstimatorRun> all_runs(double r0) {
  std::vector<EstimatorRun> runs;
  for (const Estimator estimator : tests::all_estimators()) {
    for (const std::uint32_t iterations : {1u, 3u}) {
      if (!takes(estimator, iterations)) continue;
      runs.emplace_back(estimator, r0).parameters.iterations = iterations;
    }
  }
  return runs;
}

std::string name_of(const EstimatorRun& run) {
  return name_of(run.parameters.estimator) + ", iterations " +
         std::to_string(run.parameters.iterations);
}

bool is_control(const EstimatorRun& run) {
  return run.parameters.estimator == Estimator::control;
}
bool is_over_area(const EstimatorRun& run) {
  return filter::info(run.parameters.estimator).is_over_area;
}

TEST_CASE("With r0 = 0 every estimator gives each contribution back, bit for bit") {
  RecordSet set = some_records(900, 1, 0);
  set.contribution[4] = Rgb(-0.0f, 1e-42f, 3e38f);
  for (EstimatorRun& run : all_runs(0)) {
    for (const bool demodulate : {false, true}) {
      run.parameters.demodulate = demodulate;
      const Estimates result = run(set);
      INFO(name_of(run));
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < set.size(); ++i) {
        if (result.roles[i] != filter::Role::source) continue;
        wrong += std::memcmp(&result.c_bar[i], &set.contribution[i], sizeof(Rgb)) != 0 ? 1u : 0u;
      }
      CHECK(wrong == 0);
      CHECK(result.statistics.sources > 700);
      CHECK(result.statistics.mean_neighbors() == 1);
    }
  }
}

TEST_CASE("Constant c gives c back from every estimator, unshaded records and orphans too") {
  RecordSet set = some_records(900, 2, 0.5);
  const Rgb c(0.1f, 7, 1e-30f);
  for (std::size_t i = 0; i < set.size(); ++i)
    set.contribution[i] = set.flags[i] == 3 ? c : Rgb(99);
  for (const double r0 : {0.0, 0.01, 0.2, 5.0}) {
    for (EstimatorRun& run : all_runs(r0)) {
      // A disk has the area that it has, whatever lies on it.
      if (is_over_area(run) && r0 > 0) continue;
      // A control differs from c by rounding, and where it looks at nobody it is 0.
      if (is_control(run) && r0 == 0) continue;
      INFO(name_of(run) << ", r0 " << r0);
      run.passes = 2;  // as many as there are records for each that is shaded: beta is 1
      const Estimates result = run(set);
      for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.flags[i] == 0) continue;
        for (int k = 0; k < 3; ++k)
          REQUIRE(result.c_bar[i][k] == Approx(c[k]).epsilon(is_control(run) ? 1e-5 : 0));
      }
    }
  }
}

TEST_CASE("A ball that holds the block, without weights, gives the block's mean") {
  const RecordSet set = some_records(900, 3, 0.1);
  EstimatorRun run(Estimator::average);
  run.parameters.radius = {10, filter::RadiusBasis::world, 0.5, {}};
  run.parameters.weights = filter::WeightTerms::none();
  run.n = 4;
  const Estimates result = run(set);
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

TEST_CASE("The same bytes for any number of threads from every estimator") {
  const RecordSet set = some_records(20000, 4, 0);
  for (EstimatorRun& run : all_runs(0.3)) {
    run.parameters.weights.gloss.reset();  // it leaves random directions few neighbours
    run.parameters.demodulate = true;
    run.parameters.sources = 3;
    run.parameters.count_refusals = filter::info(run.parameters.estimator).is_of_ball;
    const auto with_threads = [&](std::size_t threads) {
      const core::ThreadLimit limit(threads);
      return run(set);
    };
    INFO(name_of(run));
    const Estimates one = with_threads(1);
    CHECK(one.statistics.mean_neighbors() > 2);
    for (const std::size_t threads : {2u, 4u}) {
      const Estimates many = with_threads(threads);
      CHECK(tests::same_bytes(one.c_bar, many.c_bar));
      CHECK(one.neighbors == many.neighbors);
      CHECK(one.radius == many.radius);
      CHECK(one.roles == many.roles);
      CHECK(one.statistics.orphans == many.statistics.orphans);
      CHECK(one.statistics.candidates == many.statistics.candidates);
      CHECK(one.statistics.refused == many.statistics.refused);
    }
  }
}

TEST_CASE("With default weights no estimator crosses a thin wall or a 90 degree edge") {
  const RecordSet wall = tests::two_sheets({0, -1, 0}, {0, 0, 1}, {1, 0, 0}, {0, -1e-4f, 0});
  const RecordSet edge = tests::two_sheets({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 0});
  for (EstimatorRun& run : all_runs(0.3)) {
    INFO(name_of(run));
    for (const RecordSet* set : {&wall, &edge}) {
      const Estimates result = run(*set);
      for (std::size_t i = 0; i < set->size(); ++i) {
        if (is_over_area(run) && i < 400) {
          REQUIRE(result.c_bar[i].x > 0);
        } else {
          REQUIRE(result.c_bar[i] == set->contribution[i]);
        }
      }
      // With all contributions a control uses no others.
      if (!is_control(run)) CHECK(result.statistics.mean_neighbors() > 10);
    }
    if (is_control(run)) continue;
    run.parameters.weights = filter::WeightTerms::none();
    for (const RecordSet* set : {&wall, &edge}) {
      const Estimates open = run(*set);
      CHECK(std::any_of(open.c_bar.begin() + 400, open.c_bar.end(),
                        [](const Rgb& c) { return c.x > 1; }));
    }
  }
}

TEST_CASE("A bad value takes its record out and changes no other, whatever the estimator") {
  const RecordSet clean = some_records(600, 1, 0);
  std::size_t victim = 100;
  while (clean.flags[victim] != 3) ++victim;
  RecordSet without = clean;
  without.flags[victim] = 0;
  for (EstimatorRun& run : all_runs(0.3)) {
    INFO(name_of(run));
    run.parameters.sources = 2;
    const Estimates expected = run(without);
    RecordSet sets[4] = {clean, clean, clean, clean};
    sets[0].contribution[victim].y = tests::kNan;
    sets[1].position[victim].x = tests::kNan;
    sets[2].normal[victim].z = tests::kNan;
    sets[3].distance[victim] = tests::kInfinity;
    for (const RecordSet& set : sets) {
      const Estimates result = run(set);
      CHECK(result.roles[victim] == filter::Role::left_out);
      CHECK(result.statistics.left_out == 1);
      CHECK(result.c_bar == expected.c_bar);
      CHECK(result.neighbors == expected.neighbors);
    }
  }
}

TEST_CASE("Demodulated, a texture stays sharp under a constant light") {
  RecordSet set = some_records(900, 5, 0);
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.reflectance[i].y = 0.1f + 0.001f * static_cast<float>(i);
    set.contribution[i] = set.reflectance[i] * 3.0f;
  }
  for (EstimatorRun& run : all_runs(1)) {
    if (is_over_area(run)) continue;
    INFO(name_of(run));
    run.parameters.weights = filter::WeightTerms::none();
    run.parameters.demodulate = true;
    const Estimates result = run(set);
    // Green, whose reflectance is nowhere 0.
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (set.flags[i] != 0)
        REQUIRE(result.c_bar[i].y == Approx(set.contribution[i].y).epsilon(1e-6));
    }
  }
}

TEST_CASE("No records, one record, no source: no estimator fails") {
  for (const EstimatorRun& run : all_runs(0.3)) {
    INFO(name_of(run));
    CHECK(run(RecordSet(0)).c_bar.empty());
    const RecordSet one(1);
    if (!is_over_area(run)) CHECK(run(one).c_bar[0] == one.contribution[0]);
    RecordSet unshaded(5);
    unshaded.flags.assign(5, filter::kHasVertex);
    const Estimates result = run(unshaded);
    CHECK(result.statistics.without_source == 5);
    CHECK(result.roles[2] == filter::Role::left_out);
  }
}

}  // namespace
}  // namespace psf
