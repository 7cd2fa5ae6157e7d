// Layers of the light: each is averaged as if it were alone, and together they are the whole.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "catch.h"
#include "core/parallel.h"
#include "engine_case.h"
#include "estimator_case.h"
#include "filter/estimate.h"
#include "filter/radius.h"

namespace psf {
namespace {

using filter::Estimates;
using filter::Estimator;
using tests::kEngines;
using tests::RecordSet;

// Contributions cut into three parts, one of them black for most records, beside the whole.
struct Parts {
  RecordSet set;
  std::vector<std::vector<Rgb>> parts{3};
  std::vector<filter::Layer> layers;

  explicit Parts(std::uint32_t seed, double share_unshaded)
      : set(tests::random_records(900, seed, share_unshaded, tests::kCamera)) {
    for (std::size_t i = 0; i < set.size(); ++i) {
      Rgb& c = set.contribution[i];
      if (set.position[i].x < 0.5f) c *= 10;  // an edge, which balls of adaptive do not cross
      const float share = i % 5 == 0 ? 0.75f : 0;
      parts[0].push_back(c * share);
      parts[1].push_back(Rgb(c.x, 0, 0.5f * c.z) * (1 - share));
      parts[2].push_back(Rgb(0, c.y, 0.5f * c.z) * (1 - share));
    }
    for (const auto& part : parts) layers.push_back({part, {}});
    layers.insert(layers.begin() + 1, filter::Layer{});  // of u alone
  }
  [[nodiscard]] filter::Records with_layers() const {
    filter::Records records = set.view();
    records.layers = layers;
    return records;
  }
};

Estimates run(const filter::Records& records, const filter::Parameters& parameters) {
  const filter::Block block{0, 1, 1, tests::kCamera};
  std::vector<float> radius;
  filter::radii(parameters.radius, records, block, radius);
  return filter::estimate(records, radius, block, parameters);
}

filter::Parameters parameters_of(Estimator estimator, filter::EngineKind engine, bool demodulate,
                                 std::uint32_t iterations = 1) {
  filter::Parameters parameters;
  parameters.estimator = estimator;
  parameters.engine = engine;
  parameters.radius = {0.2, filter::RadiusBasis::distance};
  parameters.weights = tests::terms_of(7);
  parameters.demodulate = demodulate;
  parameters.iterations = iterations;
  return parameters;
}

TEST_CASE("A layer is what the filter makes of it alone, bit for bit, and the whole stays") {
  std::size_t orphans = 0;
  for (const Estimator estimator : {Estimator::average, Estimator::disk, Estimator::hash}) {
    for (const filter::EngineKind engine : kEngines) {
      for (const std::uint32_t iterations : {1u, 3u}) {
        if (estimator != Estimator::average && iterations > 1) continue;
        for (const bool demodulate : {false, true}) {
          const Parts parts(3, 0.7);
          const auto parameters = parameters_of(estimator, engine, demodulate, iterations);
          INFO(tests::name_of(estimator) << ", demodulate " << demodulate);
          const Estimates layered = run(parts.with_layers(), parameters);
          const Estimates whole = run(parts.set.view(), parameters);
          CHECK(tests::same_bytes(layered.c_bar, whole.c_bar));
          CHECK(layered.neighbors == whole.neighbors);
          CHECK(layered.statistics.accepted == whole.statistics.accepted);
          CHECK(layered.statistics.orphans == whole.statistics.orphans);
          CHECK(layered.statistics.orphans_unmatched == whole.statistics.orphans_unmatched);
          orphans += whole.statistics.orphans;
          REQUIRE(layered.layers.size() == 4);
          CHECK(layered.layers[1].empty());
          for (const std::size_t k : {0u, 2u, 3u}) {
            filter::Records alone = parts.set.view();
            alone.contribution = parts.layers[k].contribution;
            CHECK(tests::same_bytes(layered.layers[k], run(alone, parameters).c_bar));
          }
        }
      }
    }
  }
  CHECK(orphans > 100);
}

TEST_CASE("The layers add up to the whole, by every estimator") {
  for (const Estimator estimator : tests::all_estimators()) {
    for (const filter::EngineKind engine : kEngines) {
      const Parts parts(4, estimator == Estimator::control ? 0 : 0.5);
      auto parameters = parameters_of(estimator, engine, false);
      if (estimator == Estimator::control) parameters.sources = 2;
      const Estimates result = run(parts.with_layers(), parameters);
      INFO(tests::name_of(estimator));
      std::size_t wrong = 0, used = 0;
      for (std::size_t i = 0; i < parts.set.size(); ++i) {
        if (!filter::is_query(result.roles[i])) continue;
        ++used;
        for (int k = 0; k < 3; ++k) {
          double sum = 0, size = 0;
          for (const auto& layer : result.layers) {
            if (layer.empty()) continue;
            sum += double{layer[i][k]};
            size += std::abs(double{layer[i][k]});
          }
          // [control] is g + K (c - g): rounding is that of its parts.
          if (estimator == Estimator::control) size += 4 * double{parts.set.contribution[i][k]};
          wrong += std::abs(sum - double{result.c_bar[i][k]}) <= 1e-6 * size + 1e-30 ? 0u : 1u;
        }
      }
      CHECK(wrong == 0);
      CHECK(used > 700);
    }
  }
}

TEST_CASE("The radii of adaptive and the controls of control are those of the whole") {
  const Parts parts(5, 0);
  auto parameters = parameters_of(Estimator::adaptive, filter::EngineKind::flann, false);
  parameters.weights = filter::WeightTerms::none();
  parameters.radius.r0 = 0.4;
  const Estimates adaptive = run(parts.with_layers(), parameters);
  CHECK(adaptive.radius == run(parts.set.view(), parameters).radius);
  filter::Records alone = parts.set.view();
  alone.contribution = parts.layers[0].contribution;
  CHECK((adaptive.radius != run(alone, parameters).radius));  // a test that could tell
  parameters = parameters_of(Estimator::control, filter::EngineKind::flann, true);
  parameters.sources = 3;
  CHECK(tests::same_bytes(run(parts.with_layers(), parameters).c_bar,
                          run(parts.set.view(), parameters).c_bar));
}

TEST_CASE("Layers are the same bytes for any number of threads") {
  const Parts parts(6, 0.5);
  for (const Estimator estimator : tests::all_estimators()) {
    auto parameters = parameters_of(estimator, filter::EngineKind::flann, true);
    INFO(tests::name_of(estimator));
    std::vector<std::vector<Rgb>> one;
    for (const std::size_t threads : {1u, 2u, 5u}) {
      const core::ThreadLimit limit(threads);
      const Estimates result = run(parts.with_layers(), parameters);
      if (threads == 1) one = result.layers;
      REQUIRE(one.size() == 4);
      for (std::size_t k = 0; k < one.size(); ++k) {
        CHECK(tests::same_bytes(result.layers[k], one[k]));
      }
    }
  }
}

}  // namespace
}  // namespace psf
