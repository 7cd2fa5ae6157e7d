// A dump filtered for many radii at once is what separate runs give, on the way and at the end.
#include "run/many_dump.h"

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "filter/many_radii.h"
#include "filter_dump_setup.h"
#include "picture_difference.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

std::vector<filter::Radius> pairs() {
  std::vector<filter::Radius> radii;
  for (const double r0 : {0.05, 0.1, 0.25, 0.4}) {
    for (const double delta : {0.0, 0.25, 0.5}) {
      radii.push_back({r0, filter::RadiusBasis::distance, delta});
    }
  }
  return radii;
}

run::ManyRequest many_run(const std::string& block) {
  run::ManyRequest run;
  run.parameters = default_run(block).parameters;
  run.radii = pairs();
  return run;
}

// Compares with filter_dump() over the first `passes` passes.
void check(const std::string& path, const run::ManyRequest& run, const run::ManyResult& outcome,
           std::uint64_t passes) {
  for (std::size_t k = 0; k < run.radii.size(); ++k) {
    FilterRequest separate;
    separate.parameters = run.parameters;
    separate.parameters.radius = run.radii[k];
    separate.passes = run.passes;
    separate.passes.last = run.passes.first + passes;
    const run::FilterResult expected = run::filter_dump(run::Dump(path), separate);
    INFO("radius " << k << ", " << passes << " passes");
    CHECK(outcome.statistics[k].accepted == expected.statistics.accepted);
    CHECK(outcome.statistics[k].orphans == expected.statistics.orphans);
    CHECK(outcome.blocks == expected.blocks);
    for (std::size_t camera = 0; camera < expected.pictures.size(); ++camera) {
      const film::Image image = expected.pictures[camera].image();
      CHECK(largest_difference(outcome.pictures[camera].filtered(k), image.rgb()) < 1e-5);
      CHECK(largest_difference(outcome.pictures[camera].unfiltered(),
                               image.rgb("unfiltered-input.")) < 1e-5);
    }
  }
}

TEST_CASE("Many radii on a dump equal separate runs, at every number of passes") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  RecordSet set = random_records(1500, 4, 0.2, kTwo);
  set.contribution[77].x = std::numeric_limits<float>::infinity();
  write_dump(path, set, {kTwo, {200, 250, 150, 200, 400, 100, 200}, {}});
  const run::Dump dump(path);
  for (const std::string block : {"1pass", "2passes", "4passes", "2^8", "all"}) {
    INFO("blocks of " << block);
    run::ManyRequest run = many_run(block);
    run.n = {1, 2, 3, 4, 7};
    std::vector<std::uint64_t> seen;
    run.on_pictures = [&](std::uint64_t n, const run::ManyResult& outcome) {
      seen.push_back(n);
      check(path, run, outcome, n);
    };
    const run::ManyResult outcome = run::filter_many(dump, run);
    CHECK(seen == run.n);
    check(path, run, outcome, 7);
  }
}

TEST_CASE("Radii that share no traversal equal separate runs too") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  const PhotonSet photons = random_photons(900, 14);
  DumpOptions options{kOne, {300, 300, 300}, {}};
  options.photons = &photons;
  options.photons_of_passes = {300, 400, 200};
  write_dump(path, random_records(900, 14, 0, kOne), options);
  const run::Dump dump(path);
  for (std::size_t k = 0; k < filter::estimators().size(); ++k) {
    const filter::EstimatorInfo& estimator = filter::estimators()[k];
    run::ManyRequest run = many_run("2passes");
    run.parameters.estimator = static_cast<filter::Estimator>(k);
    if (estimator.is_of_photons) {
      run.parameters.engine = filter::EngineKind::plain;
    } else if (estimator.shares_traversal) {
      run.parameters.iterations = 2;  // which share none
    }
    INFO("estimator " << estimator.name);
    check(path, run, run::filter_many(dump, run), 3);
  }
}

TEST_CASE("Many radii on chosen passes equal separate runs") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  write_dump(path, random_records(900, 5, 0.2, kOne), {kOne, {200, 300, 200, 200}, {}});
  run::ManyRequest run = many_run("2passes");
  run.passes = {1, {}};
  check(path, run, run::filter_many(run::Dump(path), run), 3);
}

// Compares pictures and overflows of many radii with those of separate runs.
void check_overflows(const std::string& path) {
  const run::ManyRequest run = many_run("1pass");
  const run::ManyResult outcome = run::filter_many(run::Dump(path), run);
  std::uint64_t expected = 0;
  for (std::size_t k = 0; k < run.radii.size(); ++k) {
    FilterRequest separate = default_run();
    separate.parameters.radius = run.radii[k];
    const run::FilterResult one = run::filter_dump(run::Dump(path), separate);
    expected += one.overflows;
    CHECK(largest_difference(outcome.pictures[0].filtered(k), one.pictures[0].image().rgb()) <
          1e-5);
  }
  CHECK(expected > 0);
  CHECK(outcome.overflows == expected);
}

TEST_CASE("A source that overflows is in no picture, whatever its average") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  RecordSet set = random_records(400, 6, 0, kOne);
  // Its own product overflows, its average with others mostly does not.
  set.contribution[10] = Rgb(3e38f, 1, 1);
  set.throughput[10] = Rgb(2, 1, 1);
  set.flags[10] = filter::kHasVertex | filter::kShaded;
  // Products are finite, their sums with u are not.
  set.unfiltered[20] = set.unfiltered[30] = Rgb(3e38f, 0, 0);
  set.contribution[30] = Rgb(3e38f, 1, 1);
  set.flags[30] = filter::kHasVertex | filter::kShaded;
  write_dump(path, set, {kOne, {200, 200}, {}});
  check_overflows(path);
}

TEST_CASE("A path that overflows is left out of its radius alone") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  RecordSet set = random_records(400, 6, 0, kOne);
  for (std::size_t i = 0; i < 400; i += 50) set.contribution[i] = Rgb(1e30f, 1, 1);
  for (std::size_t i = 0; i < 400; i += 9) set.throughput[i] = Rgb(1e10f, 1, 1);
  write_dump(path, set, {kOne, {200, 200}, {}});
  check_overflows(path);
}

TEST_CASE("Many radii on a dump of several slabs give the same bytes for any number of threads") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  // More than a slab has, and all pixels in every part.
  constexpr std::uint32_t kPass = filter::Receiver::kMostQueries + 900;
  write_dump(path, random_records(2 * kPass, 7, 0.1, kOne), {kOne, {kPass, kPass}, {}});
  const auto pictures = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    const run::ManyResult outcome = run::filter_many(run::Dump(path), many_run("1pass"));
    std::vector<std::vector<Rgb>> all;
    for (std::size_t k = 0; k < pairs().size(); ++k) {
      all.push_back(outcome.pictures[0].filtered(k));
    }
    return all;
  };
  CHECK(pictures(1) == pictures(3));
  const run::ManyRequest run = many_run("1pass");
  check(path, run, run::filter_many(run::Dump(path), run), 2);
}

TEST_CASE("Fewer radii at once where the memory does not allow all") {
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  write_dump(path, random_records(400, 8, 0, {{1000, 1000, 0.001}}),
             {{{1000, 1000, 0.001}}, {200, 200}, {}});
  const run::Dump dump(path);
  run::ManyRequest run = many_run("1pass");
  CHECK(run::radii_at_once(dump, run) == run.radii.size());
  run.max_memory = std::uint64_t{600} << 20;
  const std::size_t some = run::radii_at_once(dump, run);
  CHECK(some < run.radii.size());
  run.radii.resize(some);
  CHECK(run::filter_many(dump, run).memory.total() <= *run.max_memory);
  run.radii = pairs();
  CHECK_THROWS_AS(run::filter_many(dump, run), Error);
}

}  // namespace
}  // namespace psf
