// The table of estimators: what each refuses, and which channels it asks for.
#include <set>

#include "catch.h"
#include "core/error.h"
#include "estimator_case.h"
#include "filter/memory.h"

namespace psf {
namespace {

using filter::Estimator;

TEST_CASE("Estimators have names of their own, and memory of their own on top of the balls'") {
  std::set<std::string_view> names;
  for (const filter::EstimatorInfo& estimator : filter::estimators()) names.insert(estimator.name);
  CHECK(names.size() == filter::estimators().size());
  const auto bytes = [](Estimator estimator) {
    filter::Parameters parameters;
    parameters.estimator = estimator;
    return filter::memory_per_record(parameters);
  };
  CHECK(bytes(Estimator::disk) == bytes(Estimator::average) + 4);
  CHECK(bytes(Estimator::control) == bytes(Estimator::average) + 61);
  CHECK(bytes(Estimator::adaptive) == bytes(Estimator::average) + 24);
  CHECK(bytes(Estimator::hash) == 37 + 172);
  CHECK(bytes(Estimator::density) == 37 + 58);
  filter::Parameters fit;
  fit.fit = filter::BallFit::linear;
  CHECK(filter::memory_per_record(fit) == bytes(Estimator::average) + 20);  // normal, luminance
  filter::Parameters spread;
  spread.fireflies = {filter::FireflyRule::Kind::clamp, 4};
  CHECK(filter::memory_per_record(spread) == bytes(Estimator::average) + 28);  // values, kept
  spread.fireflies = {filter::FireflyRule::Kind::spread};
  CHECK(filter::memory_per_record(spread) ==
        bytes(Estimator::average) + 28 + 84 + 43);  // gifts, a tree
}

TEST_CASE("A channel that only the estimator compares must be finite too") {
  for (const Estimator estimator : {Estimator::disk, Estimator::hash}) {
    tests::EstimatorRun run(estimator);
    run.parameters.weights = filter::WeightTerms::none();
    tests::RecordSet set(20);
    set.normal[3].y = tests::kNan;
    const filter::Estimates result = run(set);
    INFO(tests::name_of(estimator));
    CHECK(result.roles[3] == filter::Role::left_out);
    CHECK(result.statistics.left_out == 1);
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
  for (const Estimator estimator : tests::all_estimators())
    CHECK(message(estimator, [](Parameters&) {}).empty());
}

}  // namespace
}  // namespace psf
