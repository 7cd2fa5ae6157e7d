// What a dump cannot serve is off where nobody asked for it, and nothing else is.
#include "run/missing_terms.h"

#include "catch.h"
#include "core/error.h"
#include "filter/parameters/text.h"
#include "filter_dump_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

std::string write(const TempFolder& folder, const std::vector<std::string>& without) {
  const std::string path = folder / "a.pvb";
  write_dump(path, random_records(200, 1, 0, kOne), {kOne, {200}, without});
  return path;
}

TEST_CASE("Terms without their channel are off, but for those that were asked for") {
  const TempFolder folder;
  const run::Dump dump(write(folder, {"normal", "visibility", "hit_distance"}));
  filter::Parameters plain, all;
  plain.weights.gloss.reset();
  all.weights = terms_of(0x7F);
  std::vector<filter::Parameters> sets = {plain, all};
  CHECK(run::switch_off_missing(dump, sets, 0) ==
        folder / "a.pvb" +
            ": has no channel normal, visibility, hit_distance, so `normal`, "
            "`visibility`, `hit-distance`, `plane` are off");
  const filter::WeightTerms& few = sets[1].weights;
  CHECK_FALSE((few.normal || few.visibility || few.hit_distance || few.plane));
  CHECK((few.reflectance && few.direction && few.material));
  CHECK((sets[0].weights.reflectance && !sets[0].weights.normal && !sets[0].weights.visibility));
  CHECK_NOTHROW(dump.select(sets[0], true));
  CHECK(run::switch_off_missing(dump, sets, 0).empty());

  for (std::size_t term = 0; term < filter::kTermCount; ++term) {
    const auto text_of = [term](const filter::Parameters& parameters) {
      for (const auto& [name, value] : filter::describe(parameters)) {
        if (name == filter::kTermNames[term]) return value;
      }
      return std::string();
    };
    filter::Parameters one;
    one.weights = terms_of(1u << term);
    const std::string before = text_of(one);
    REQUIRE(before != "off");
    std::vector<filter::Parameters> kept = {one}, dropped = {one};
    CHECK(run::switch_off_missing(dump, kept, filter::TermSet{1} << term).empty());
    CHECK(text_of(kept[0]) == before);
    const bool missing = !run::switch_off_missing(dump, dropped, 0).empty();
    CHECK(text_of(dropped[0]) == (missing ? "off" : before));
    CHECK(missing == (term == 0 || term == 2 || term == 3 || term == 4 || term == 7));
  }
}

TEST_CASE("What is no weight stays an error") {
  const TempFolder folder;
  const run::Dump dump(write(folder, {"reflectance"}));
  std::vector<filter::Parameters> sets(1);
  sets[0].weights.gloss.reset();
  sets[0].demodulate = true;
  CHECK(run::switch_off_missing(dump, sets, 0) ==
        folder / "a.pvb" + ": has no channel reflectance, so `reflectance` is off");
  CHECK_THROWS_AS(dump.select(sets[0], false), Error);
}

}  // namespace
}  // namespace psf
