// Photons of a dump: whose passes a block takes, what they cannot tell, and what is refused.
#include "run/photons.h"

#include "catch.h"
#include "core/error.h"
#include "filter_dump_setup.h"
#include "run/many_dump.h"
#include "run/missing_terms.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

const std::vector<std::size_t> kLitPasses = {200, 200, 200, 200}, kLitPhotons = {300, 170, 420, 90};

// A dump of four passes with photons.
struct Lit {
  TempFolder folder;
  RecordSet set = random_records(800, 5, 0.2, kOne);
  PhotonSet photons = random_photons(980, 2);
  std::string path = folder / "a.pvb";

  explicit Lit(const std::vector<std::string>& without = {}) {
    for (std::uint16_t& camera : set.camera) camera = 0;
    DumpOptions options{kOne, kLitPasses, without};
    options.photons = &photons;
    options.photons_of_passes = kLitPhotons;
    write_dump(path, set, options);
  }
};

FilterRequest density_run(const std::string& block) {
  FilterRequest run = default_run(block);
  run.parameters.estimator = filter::Estimator::density;
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.weights.normal = 0.93f;
  run.parameters.weights.material = true;
  run.parameters.radius.delta = 0;
  return run;
}

// The pictures of blocks that end at `bounds`, from every pair of record and photon.
Expected expected(const Lit& lit, const FilterRequest& run,
                  const std::vector<std::size_t>& bounds) {
  Expected all(kOne);
  OracleResult block;
  block.c_bar.resize(lit.set.size());
  for (std::size_t b = 0; b + 1 < bounds.size(); ++b) {
    std::size_t first = 0, last = 0, passes = 0, photon = 0;
    for (std::size_t pass = 0; pass < kLitPasses.size(); ++pass) {
      if (pass * 200 < bounds[b + 1] && (pass + 1) * 200 > bounds[b]) {
        if (passes++ == 0) first = photon;
        last = photon + kLitPhotons[pass];
      }
      photon += kLitPhotons[pass];
    }
    for (std::size_t i = bounds[b]; i < bounds[b + 1]; ++i) {
      const double r = double{static_cast<float>(0.25 * double{lit.set.distance[i]})};
      const bool vertex = lit.set.flags[i] != 0;
      if (vertex) {
        block.c_bar[i] = density_at(lit.set, i, r, lit.photons, first, last,
                                    static_cast<double>(passes), run.parameters.weights)
                             .c;
      }
      all.add(lit.set, i, block, vertex);
    }
  }
  return all;
}

TEST_CASE("A block takes the photons of every pass that it overlaps, over their number") {
  const Lit lit;
  const auto differences = [&](const std::string& block, const std::vector<std::size_t>& bounds) {
    const FilterRequest run = density_run(block);
    return expected(lit, run, bounds).differences(filtered(lit.path, run));
  };
  CHECK(differences("1pass", {0, 200, 400, 600, 800}) == 0);
  CHECK(differences("3passes", {0, 600, 800}) == 0);
  CHECK(differences("all", {0, 800}) == 0);
  CHECK(differences("2^7", {0, 128, 256, 384, 512, 640, 768, 800}) == 0);
  CHECK(differences("2^9", {0, 512, 800}) == 0);
  CHECK(differences("1pass", {0, 400, 800}) > 100);  // a test that could tell
}

TEST_CASE("Chosen passes have their own photons, and r0 = 0 gives the picture without filter") {
  const Lit lit;
  FilterRequest run = density_run("all");
  run.passes = {1, 3};
  Expected part(kOne);
  const Expected block = expected(lit, run, {200, 600});
  CHECK(block.differences(filtered(lit.path, run)) == 0);
  run.passes = {};
  run.parameters.radius.r0 = 0;
  RecordSet shaded = lit.set;
  for (std::uint8_t& flags : shaded.flags) flags |= filter::kShaded;
  DumpOptions options{kOne, kLitPasses, {}};
  options.photons = &lit.photons;
  options.photons_of_passes = kLitPhotons;
  write_dump(lit.folder / "shaded.pvb", shaded, options);
  const auto pictures = filtered(lit.folder / "shaded.pvb", run);
  CHECK(pictures[0].rgb() == pictures[0].rgb("unfiltered-input."));
}

TEST_CASE("Density is the same with many radii at once, read ahead or not") {
  const Lit lit;
  const run::Dump dump(lit.path);
  const FilterRequest one = density_run("1pass");
  run::ManyRequest many;
  many.parameters = one.parameters;
  many.radii = {one.parameters.radius, one.parameters.radius};
  many.radii[0].r0 = 0.1;
  const run::ManyResult result = run::filter_many(dump, many);
  const std::vector<Rgb> alone = filtered(lit.path, one)[0].rgb();
  const std::vector<Rgb> shared = result.pictures[0].filtered(1);
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < alone.size(); ++k) {
    for (int c = 0; c < 3; ++c)
      wrong += alone[k][c] == Approx(shared[k][c]).epsilon(1e-5) ? 0u : 1u;
  }
  CHECK(wrong == 0);
}

TEST_CASE("Terms that photons cannot tell are off with a note, and an error where asked for") {
  const Lit lit;
  const run::Dump dump(lit.path);
  std::vector<filter::Parameters> sets(2);
  sets[1].estimator = filter::Estimator::density;
  CHECK(run::switch_off_missing(dump, sets, 0) ==
        lit.path + ": photons cannot tell `reflectance`, `visibility`, `gloss`, which are off");
  CHECK((sets[1].weights.normal && !sets[1].weights.reflectance && !sets[1].weights.visibility));
  CHECK((sets[0].weights.reflectance && sets[0].weights.visibility && sets[0].weights.gloss));
  for (const filter::Term term :
       {filter::Term::reflectance, filter::Term::visibility, filter::Term::hit_distance,
        filter::Term::direction, filter::Term::gloss}) {
    filter::Parameters asked;
    asked.weights = terms_of(0xFF);
    asked.estimator = filter::Estimator::density;
    CHECK_THROWS_WITH(run::switch_off_missing(dump, {&asked, 1}, filter::bit(term)),
                      Catch::Matchers::StartsWith("`" + std::string(filter::info(term).name) +
                                                  "`: photons of `estimator density` have"));
  }
  const run::Dump poor([&] {
    static const Lit without({"normal"});
    return without.path;
  }());
  std::vector<filter::Parameters> one(1);
  one[0].estimator = filter::Estimator::density;
  CHECK(run::switch_off_missing(poor, one, 0)
            .ends_with(
                "has no channel normal, so `normal` is off; photons cannot tell `reflectance`, "
                "`visibility`, `gloss`, which are off"));
  CHECK_THROWS_WITH(
      poor.select(one[0], false),
      Catch::Matchers::ContainsSubstring("has no channel normal, which `estimator density`"));
}

TEST_CASE("A dump without photons, or a pass without, is named in one line") {
  const TempFolder folder;
  const std::string path = folder / "dark.pvb";
  RecordSet set = random_records(400, 5, 0, kOne);
  DumpOptions options{kOne, {200, 200}, {}};
  write_dump(path, set, options);
  const FilterRequest run = density_run("1pass");
  CHECK_THROWS_WITH(
      filtered(path, run),
      path + ": has no photons, which `estimator density` needs; render with --photons N");

  const PhotonSet photons = random_photons(100, 2);
  options.photons = &photons;
  options.photons_of_passes = {100, 0};
  write_dump(folder / "half.pvb", set, options);
  CHECK_THROWS_WITH(filtered(folder / "half.pvb", run),
                    Catch::Matchers::EndsWith("half.pvb: pass 1 has no photons, which `estimator "
                                              "density` needs; choose other passes"));
  FilterRequest first = run;
  first.passes = {0, 1};
  CHECK_NOTHROW(filtered(folder / "half.pvb", first));

  options.photons_of_passes = {50, 50};
  options.more = {{"contribution.sun", &set.contribution}};
  write_dump(folder / "layers.pvb", set, options);
  CHECK_THROWS_WITH(filtered(folder / "layers.pvb", run),
                    Catch::Matchers::ContainsSubstring("; `layers none` does without them"));
}

TEST_CASE("The memory of a plan grows with the photons of the longest block") {
  const Lit lit;
  const run::Dump dump(lit.path);
  const auto memory = [&](const std::string& block) {
    const FilterRequest run = density_run(block);
    return run::plan_memory(dump, dump.select(run.parameters, false),
                            {run.parameters, 0, 4, std::nullopt, 0});
  };
  // Records: flags 1, position, throughput, contribution, unfiltered, normal, rho 12 each, distance,
  // pixel, material 4 each, camera 2.
  constexpr std::uint64_t kRecord = 1 + 6 * 12 + 3 * 4 + 2, kPhoton = 4 * 12 + 4;
  CHECK(memory("1pass").block == 200 * kRecord + 420 * kPhoton);
  CHECK(memory("all").block == 800 * kRecord + 980 * kPhoton);
  CHECK(memory("2^7").block == 128 * kRecord + 2 * 420 * kPhoton);  // at most two passes
  CHECK(memory("all").filter > memory("1pass").filter + 500 * kPhoton);
}

}  // namespace
}  // namespace psf
