// Errors estimated without a reference are those against it.
#include "study/tune.h"

#include <algorithm>

#include "catch.h"
#include "core/error.h"
#include "study/analytic.h"
#include "study/many_dump.h"
#include "study/metrics/reference.h"
#include "temp_folder.h"

namespace psf {
namespace {

std::vector<filter::Parameters> radii(std::uint64_t passes_a_block) {
  std::vector<filter::Parameters> sets;
  for (const double r0 : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
    filter::Parameters set;
    set.weights = filter::WeightTerms::none();
    set.radius.r0 = r0;
    set.block.passes = passes_a_block;
    sets.push_back(set);
  }
  return sets;
}

TEST_CASE("The error that halves estimate is the error against the truth") {
  const tests::TempFolder folder;
  for (const auto which : {study::AnalyticScene::smooth, study::AnalyticScene::edge}) {
    const study::Analytic scene(which);
    const std::string path = folder / (scene.name() + std::string(".pvb"));
    scene.write_dump(path, 7, 8);
    const study::Dump dump(path);
    const study::Reference reference(scene.reference(), study::Analytic::kSize, {},
                                     study::kPixelMetrics);
    for (const std::uint64_t block : {1u, 2u, 4u}) {
      const std::vector<filter::Parameters> sets = radii(block);
      study::Tune tune;
      tune.sets = sets;
      const study::Tuning tuning = study::tune(dump, tune);
      CHECK(tuning.parts == (block == 4 ? 2 : 4));
      CHECK(tuning.has_independent_paths);

      study::ManyRun run;
      run.parameters = sets[0];
      for (const filter::Parameters& set : sets) run.radii.push_back(set.radius);
      const study::ManyOutcome outcome = study::filter_many(dump, run);
      double least = 1e9, chosen = 0;
      for (std::size_t k = 0; k < sets.size(); ++k) {
        const double truth =
            reference.measure(outcome.pictures[0].filtered(k))[study::Metric::rel_mse];
        INFO(scene.name() << ", blocks of " << block << ", r0 " << sets[k].radius.r0);
        // In blocks of four passes g is the darker of two parts, and errors are somewhat high.
        const double most = block == 4 ? 2 : 1.25;
        const double noise = 4 * tuning.rows[k].standard_error - tuning.constant;
        CHECK(tuning.rows[k].error > truth / most - noise);
        CHECK(tuning.rows[k].error < truth * most + noise);
        least = std::min(least, truth);
        if (k == tuning.best) chosen = truth;
      }
      CHECK(chosen <= 1.15 * least);
      CHECK(tuning.unfiltered ==
            Approx(reference.measure(outcome.pictures[0].unfiltered())[study::Metric::rel_mse])
                .epsilon(0.3));
    }
  }
}

TEST_CASE("One block alone has no parts to compare") {
  const tests::TempFolder folder;
  const study::Analytic scene(study::AnalyticScene::smooth);
  scene.write_dump(folder / "a.pvb", 1, 2);
  study::Tune tune;
  const std::vector<filter::Parameters> sets = radii(4);
  tune.sets = sets;
  try {
    static_cast<void>(study::tune(study::Dump(folder / "a.pvb"), tune));
    FAIL("was tuned");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::usage);
    CHECK(std::string(error.what()).find("--block") != std::string::npos);
  }
}

}  // namespace
}  // namespace psf
