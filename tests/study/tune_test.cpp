// Errors estimated without a reference are those against it.
#include "study/tune.h"

#include <algorithm>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "metrics/reference.h"
#include "run/many_dump.h"
#include "runs/write_dump.h"
#include "study/analytic.h"
#include "temp_folder.h"

namespace psf {
namespace {

using tests::RecordSet;

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
    const run::Dump dump(path);
    const metrics::Reference reference(scene.reference(), study::Analytic::kSize, {},
                                       metrics::kPixelMetrics);
    for (const std::uint64_t block : {1u, 2u, 4u}) {
      const std::vector<filter::Parameters> sets = radii(block);
      study::TuneRequest tune;
      tune.sets = sets;
      const study::TuneResult tuning = study::tune(dump, tune);
      CHECK(tuning.parts == (block == 4 ? 2 : 4));
      CHECK(tuning.has_independent_paths);

      run::ManyRequest run;
      run.parameters = sets[0];
      for (const filter::Parameters& set : sets) run.radii.push_back(set.radius);
      const run::ManyResult outcome = run::filter_many(dump, run);
      double least = 1e9, chosen = 0;
      for (std::size_t k = 0; k < sets.size(); ++k) {
        const double truth =
            reference.measure(outcome.pictures[0].filtered(k))[metrics::Metric::rel_mse];
        INFO(scene.name() << ", blocks of " << block << ", r0 " << sets[k].radius.r0);
        const double most = 1.25;
        const double noise = 4 * tuning.rows[k].standard_error - tuning.constant;
        CHECK(tuning.rows[k].error > truth / most - noise);
        CHECK(tuning.rows[k].error < truth * most + noise);
        least = std::min(least, truth);
        if (k == tuning.best) chosen = truth;
      }
      CHECK(chosen <= 1.15 * least);
      CHECK(tuning.unfiltered ==
            Approx(reference.measure(outcome.pictures[0].unfiltered())[metrics::Metric::rel_mse])
                .epsilon(0.3));
    }
  }
}

constexpr std::size_t kTuneSide = 64;  // pixels
constexpr std::size_t kPasses = 8;

// A square of kTuneSide x kTuneSide pixels, seen from above at distance 1, with noise of mean
// `truth(x)` a column, `u` added to each path.
template <class Truth, class Unfiltered>
RecordSet square(const Truth& truth, const Unfiltered& u) {
  std::mt19937 random(3);
  std::exponential_distribution<double> exponential;
  RecordSet set(kTuneSide * kTuneSide * kPasses);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const std::size_t pixel = i % (kTuneSide * kTuneSide), x = pixel % kTuneSide,
                      y = pixel / kTuneSide;
    set.pixel[i] = static_cast<std::uint32_t>(pixel);
    set.position[i] = Vec3((static_cast<float>(x) + 0.5f) / kTuneSide,
                           (static_cast<float>(y) + 0.5f) / kTuneSide, 0);
    const auto c = static_cast<float>(truth(x) * exponential(random));
    set.contribution[i] = Rgb(c, c, c);
    const auto more = static_cast<float>(u(i));
    set.unfiltered[i] = Rgb(more, more, more);
  }
  return set;
}

study::TuneResult tune_square(const std::string& path, const RecordSet& set,
                              const std::vector<filter::Parameters>& sets) {
  tests::DumpOptions options;
  options.cameras = {{kTuneSide, kTuneSide, 1.0 / kTuneSide}};
  options.passes.assign(kPasses, kTuneSide * kTuneSide);
  options.chunk_capacity = kTuneSide * kTuneSide;
  tests::write_dump(path, set, options);
  study::TuneRequest tune;
  tune.sets = sets;
  return study::tune(run::Dump(path), tune);
}

TEST_CASE("A set's own smear does not make its error seem small") {
  // A bright line on the dark, as the rim of a lamp: wide balls make a bright band of it.
  const tests::TempFolder folder;
  const std::size_t line = kTuneSide / 2;
  const auto truth = [&](std::size_t x) { return x >= line && x < line + 3 ? 300.0 : 0.3; };
  const std::vector<filter::Parameters> sets = radii(1);
  const study::TuneResult tuning =
      tune_square(folder / "a.pvb", square(truth, [](std::size_t) { return 0.0; }), sets);
  std::vector<Rgb> picture(kTuneSide * kTuneSide);
  for (std::size_t k = 0; k < picture.size(); ++k) {
    const auto value = static_cast<float>(truth(k % kTuneSide));
    picture[k] = Rgb(value, value, value);
  }
  const metrics::Reference reference(picture, kTuneSide, {}, metrics::kPixelMetrics);
  run::ManyRequest run;
  run.parameters = sets[0];
  for (const filter::Parameters& set : sets) run.radii.push_back(set.radius);
  const run::ManyResult outcome = run::filter_many(run::Dump(folder / "a.pvb"), run);
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const double error =
        reference.measure(outcome.pictures[0].filtered(k))[metrics::Metric::rel_mse];
    INFO("r0 " << sets[k].radius.r0);
    CHECK(tuning.rows[k].error > error / 3);
    CHECK(tuning.rows[k].error < error * 3);
  }
}

TEST_CASE("The noise of u is told apart and decides nothing") {
  const tests::TempFolder folder;
  const auto truth = [](std::size_t x) { return 1 + static_cast<double>(x) / kTuneSide; };
  const auto none = [](std::size_t) { return 0.0; };
  const auto fireflies = [](std::size_t i) { return i % 997 == 0 ? 1e3 : 0.0; };
  const std::vector<filter::Parameters> sets = radii(1);
  const study::TuneResult without = tune_square(folder / "a.pvb", square(truth, none), sets);
  const study::TuneResult with = tune_square(folder / "b.pvb", square(truth, fireflies), sets);
  CHECK(without.u_variance == 0);
  // The variance of 1 bright path in 997, with kPasses paths per pixel; 1 / (g^2 + epsilon) is
  // between 1/4 and 1.
  const double variance = 1e6 / 997 / kPasses;
  CHECK(with.u_variance > variance / 4);
  CHECK(with.u_variance < variance);
  CHECK(with.unfiltered > with.u_variance);
  CHECK(with.best == without.best);
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const study::TuneRow &a = with.rows[k], &b = without.rows[k];
    CHECK(a.error > with.u_variance / 2);
    CHECK(a.variance == Approx(b.variance).epsilon(0.05));
    CHECK(a.bias_sq + a.variance == Approx(b.bias_sq + b.variance).epsilon(0.05));
    CHECK(a.standard_error == Approx(b.standard_error).epsilon(0.1));
    CHECK(a.may_be_better == b.may_be_better);
  }
}

TEST_CASE("Where u and alpha c make up for each other, errors are those of the whole picture") {
  // Each path meets either a sky or a surface, both of radiance 1: all pictures are 1.
  const tests::TempFolder folder;
  const auto one = [](std::size_t) { return 1.0; };
  const auto none = [](std::size_t) { return 0.0; };
  RecordSet set = square(one, none);
  std::mt19937 random(5);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const bool sky = random() % 2 == 0;
    set.flags[i] = sky ? 0 : filter::kHasVertex | filter::kShaded;
    set.unfiltered[i] = sky ? Rgb(1, 1, 1) : Rgb(0, 0, 0);
    set.contribution[i] = Rgb(1, 1, 1);
  }
  const std::vector<filter::Parameters> sets = radii(1);
  const study::TuneResult tuning = tune_square(folder / "a.pvb", set, sets);
  CHECK(tuning.unfiltered == Approx(0).margin(1e-9));
  CHECK(tuning.u_variance > 0.02);
  CHECK(tuning.u_covariance == Approx(-2 * tuning.u_variance).epsilon(1e-6));
  for (const study::TuneRow& row : tuning.rows) {
    CHECK(row.variance > 0.02);
    CHECK(row.error == Approx(0).margin(1e-9));
    CHECK_FALSE(row.may_be_better);
  }
}

TEST_CASE("Errors are those of the noise of c where u and alpha make up for each other") {
  const tests::TempFolder folder;
  const auto one = [](std::size_t) { return 1.0; };
  const auto none = [](std::size_t) { return 0.0; };
  RecordSet set = square(one, none);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.9f, 1.1f);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const bool sky = random() % 2 == 0;
    set.flags[i] = sky ? 0 : filter::kHasVertex | filter::kShaded;
    set.unfiltered[i] = sky ? Rgb(1, 1, 1) : Rgb(0, 0, 0);
    set.contribution[i] = Rgb(unit(random));
  }
  const std::vector<filter::Parameters> sets = radii(1);
  const study::TuneResult tuning = tune_square(folder / "a.pvb", set, sets);
  const study::TuneRow& wide = tuning.rows[5];
  CHECK(wide.error < 0.25 * tuning.rows[0].error);
  for (const study::TuneRow& row : tuning.rows) CHECK(row.error < 1e-3);
  CHECK(tuning.unfiltered == Approx(tuning.rows[0].error).epsilon(0.3));
}

TEST_CASE("Progress ends with the last reading, and the noise is of the paths that were chosen") {
  const tests::TempFolder folder;
  const auto one = [](std::size_t) { return 1.0; };
  const auto none = [](std::size_t) { return 0.0; };
  const RecordSet set = square(one, none);
  std::vector<filter::Parameters> sets = radii(1);
  const study::TuneResult all = tune_square(folder / "a.pvb", set, sets);
  for (filter::Parameters& parameters : sets) parameters.sources = 2;
  const run::Dump dump(folder / "a.pvb");
  study::TuneRequest tune;
  tune.sets = sets;
  std::uint64_t last = 0, of = 0, before_noise = 0;
  tune.on_progress = [&](std::uint64_t done, std::uint64_t total) {
    CHECK(done >= last);
    before_noise = last;
    last = done;
    of = total;
  };
  const study::TuneResult half = study::tune(dump, tune);
  CHECK(last == of);
  CHECK(before_noise <= of / 2);
  // Half of the paths have twice the noise.
  CHECK(half.noise.variance() == Approx(2 * all.noise.variance()).epsilon(0.2));
}

TEST_CASE("A picture of one tile says nothing of its noise") {
  const tests::TempFolder folder;
  RecordSet set(8 * 8 * 4);
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.pixel[i] = static_cast<std::uint32_t>(i % 64);
    set.contribution[i].x = static_cast<float>(i % 7);
  }
  tests::DumpOptions options;
  options.cameras = {{8, 8, 1.0 / 8}};
  options.passes.assign(4, 64);
  tests::write_dump(folder / "a.pvb", set, options);
  const std::vector<filter::Parameters> sets = radii(1);
  study::TuneRequest tune;
  tune.sets = sets;
  const study::TuneResult tuning = study::tune(run::Dump(folder / "a.pvb"), tune);
  for (std::size_t k = 0; k < sets.size(); ++k) {
    CHECK(tuning.rows[k].may_be_better == (k != tuning.best));
  }
}

TEST_CASE("One block alone has no parts to compare") {
  const tests::TempFolder folder;
  const study::Analytic scene(study::AnalyticScene::smooth);
  scene.write_dump(folder / "a.pvb", 1, 2);
  study::TuneRequest tune;
  const std::vector<filter::Parameters> sets = radii(4);
  tune.sets = sets;
  try {
    static_cast<void>(study::tune(run::Dump(folder / "a.pvb"), tune));
    FAIL("was tuned");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::usage);
    CHECK(std::string(error.what()).find("`block`") != std::string::npos);
  }
}

}  // namespace
}  // namespace psf
