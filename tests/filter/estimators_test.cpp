// What is always true of the filter is true of every estimator.

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "estimator_case.h"
#include "filter/memory.h"

namespace psf {
namespace {

using filter::Average;
using filter::Estimator;
using tests::EstimatorRun;
using tests::RecordSet;

constexpr Estimator kNew[] = {Estimator::hash, Estimator::control, Estimator::adaptive};

const char* name_of(Estimator estimator) {
  return filter::kEstimatorNames[static_cast<std::size_t>(estimator)];
}

RecordSet some_records(std::size_t count, std::uint32_t seed, double share_unshaded) {
  return tests::random_records(count, seed, share_unshaded, EstimatorRun(kNew[0]).cameras);
}

TEST_CASE("With r0 = 0 every estimator gives each contribution back, bit for bit") {
  RecordSet set = some_records(900, 1, 0);
  set.contribution[4] = Rgb(-0.0f, 1e-42f, 3e38f);
  for (const Estimator estimator : kNew) {
    for (const bool demodulate : {false, true}) {
      EstimatorRun run(estimator, 0);
      run.parameters.demodulate = demodulate;
      const Average result = run(set);
      INFO(name_of(estimator));
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

TEST_CASE("Constant c gives c back from every estimator") {
  RecordSet set = some_records(900, 2, 0.5);
  const Rgb c(0.1f, 7, 1e-30f);
  for (std::size_t i = 0; i < set.size(); ++i)
    set.contribution[i] = set.flags[i] == 3 ? c : Rgb(99);
  for (const Estimator estimator : kNew) {
    // A control differs from c by rounding, and where it looks at nobody it is 0.
    const bool exact = estimator != Estimator::control;
    for (const double r0 : {0.0, 0.01, 0.2, 5.0}) {
      if (!exact && r0 == 0) continue;
      INFO(name_of(estimator) << ", r0 " << r0);
      EstimatorRun run(estimator, r0);
      run.passes = 2;  // as many as there are records for each that is shaded: beta is 1
      const Average result = run(set);
      for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.flags[i] == 0) continue;
        for (int k = 0; k < 3; ++k)
          REQUIRE(result.c_bar[i][k] == Approx(c[k]).epsilon(exact ? 0 : 1e-5));
      }
    }
  }
}

TEST_CASE("The same bytes for any number of threads from every estimator") {
  const RecordSet set = some_records(20000, 4, 0);
  for (const Estimator estimator : kNew) {
    EstimatorRun run(estimator, 0.3);
    run.parameters.weights.gloss.reset();  // it leaves random directions few neighbours
    run.parameters.demodulate = true;
    run.parameters.sources = 3;
    const auto with_threads = [&](std::size_t threads) {
      const core::ThreadLimit limit(threads);
      return run(set);
    };
    INFO(name_of(estimator));
    const Average one = with_threads(1);
    CHECK(one.statistics.mean_neighbors() > 2);
    for (const std::size_t threads : {2u, 4u}) {
      const Average many = with_threads(threads);
      CHECK(tests::same_bytes(one.c_bar, many.c_bar));
      CHECK(one.neighbors == many.neighbors);
      CHECK(one.roles == many.roles);
      CHECK(one.statistics.orphans == many.statistics.orphans);
    }
  }
}

TEST_CASE("With default weights no estimator crosses a thin wall or a 90 degree edge") {
  const RecordSet wall = tests::two_sheets({0, -1, 0}, {0, 0, 1}, {1, 0, 0}, {0, -1e-4f, 0});
  const RecordSet edge = tests::two_sheets({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 0});
  for (const Estimator estimator : kNew) {
    EstimatorRun run(estimator);
    for (const RecordSet& set : {wall, edge}) {
      const Average result = run(set);
      INFO(name_of(estimator));
      for (std::size_t i = 0; i < set.size(); ++i) REQUIRE(result.c_bar[i] == set.contribution[i]);
    }
    if (estimator == Estimator::control) continue;  // with all contributions it uses no others
    CHECK(run(wall).statistics.mean_neighbors() > 10);
    run.parameters.weights = filter::WeightTerms::none();
    const Average open = run(wall);
    CHECK(std::any_of(open.c_bar.begin() + 400, open.c_bar.end(),
                      [](const Rgb& c) { return c.x > 10; }));
  }
}

TEST_CASE("A bad value takes its record out and changes no other, whatever the estimator") {
  const RecordSet clean = some_records(600, 1, 0);
  std::size_t victim = 100;
  while (clean.flags[victim] != 3) ++victim;
  RecordSet without = clean;
  without.flags[victim] = 0;
  for (const Estimator estimator : kNew) {
    EstimatorRun run(estimator);
    run.parameters.sources = 2;
    const Average expected = run(without);
    RecordSet sets[4] = {clean, clean, clean, clean};
    sets[0].contribution[victim].y = tests::kNan;
    sets[1].position[victim].x = tests::kNan;
    sets[2].normal[victim].z = tests::kNan;
    sets[3].distance[victim] = tests::kInfinity;
    for (const RecordSet& set : sets) {
      const Average result = run(set);
      INFO(name_of(estimator));
      CHECK(result.roles[victim] == filter::Role::left_out);
      CHECK(result.statistics.left_out == 1);
      CHECK(result.c_bar == expected.c_bar);
      CHECK(result.neighbors == expected.neighbors);
    }
  }
}

TEST_CASE("No records, one record, no source: no estimator fails") {
  for (const Estimator estimator : kNew) {
    INFO(name_of(estimator));
    const EstimatorRun run(estimator);
    CHECK(run(RecordSet(0)).c_bar.empty());
    const RecordSet one(1);
    CHECK(run(one).c_bar[0] == one.contribution[0]);
    RecordSet unshaded(5);
    unshaded.flags.assign(5, filter::kHasVertex);
    const Average result = run(unshaded);
    CHECK(result.statistics.without_source == 5);
    CHECK(result.roles[2] == filter::Role::left_out);
  }
}

TEST_CASE("What an estimator cannot do is refused in one line that names the option") {
  const auto message = [](Estimator estimator, auto change) {
    filter::Parameters parameters;
    parameters.estimator = estimator;
    change(parameters);
    try {
      parameters.validate();
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::usage);
      return std::string(error.what());
    }
    return std::string();
  };
  using filter::Parameters;
  const auto starts = [](const std::string& text, const char* with) {
    INFO(text);
    CHECK(text.rfind(with, 0) == 0);
  };
  starts(message(Estimator::hash, [](Parameters& p) { p.weights.plane = 1.0f; }), "`plane`:");
  starts(message(Estimator::hash, [](Parameters& p) { p.iterations = 2; }), "`iterations`:");
  starts(message(Estimator::hash, [](Parameters& p) { p.count_refusals = true; }), "`refusals`:");
  starts(message(Estimator::control, [](Parameters& p) { p.iterations = 2; }), "`iterations`:");
  starts(message(Estimator::control, [](Parameters& p) { p.count_refusals = true; }),
         "`refusals`:");
  for (const Estimator estimator : kNew) CHECK(message(estimator, [](Parameters&) {}).empty());
}

}  // namespace
}  // namespace psf
