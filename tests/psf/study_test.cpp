// Studies of the library through its own headers: lists of parameters, tuning, convergence,
// explanations, and calls that are ended. That their figures are those of the commands to the last
// digit is the test of the Python package.
#include <atomic>
#include <cmath>
#include <filesystem>
#include <thread>

#include "catch.h"
#include "plane.h"
#include "psf/psf.h"
#include "read_text.h"
#include "temp_folder.h"

namespace {

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using psf::tests::kSide;
using psf::tests::Plane;
using psf::tests::TempFolder;

double value(const psf::ConvergeRow& row, const std::string& name) {
  for (const auto& [key, number] : row.values) {
    if (key == name) return number;
  }
  FAIL("no " << name);
  return 0;
}

std::vector<psf::Parameters> sets(const std::string& r0) {
  return psf::Parameters::combinations({{"r0", r0}, {"block", "1pass"}});
}

}  // namespace

TEST_CASE("lists give every combination, r0 and delta fastest") {
  const auto all =
      psf::Parameters::combinations({{"r0", "2px:8px:x2"}, {"normal", "0.9,off"}}, true);
  REQUIRE(all.size() == 6);
  CHECK(all[0].get("r0") == "2px");
  CHECK(all[1].get("r0") == "4px");
  CHECK(all[1].get("normal") == "0.9");
  CHECK(all[3].get("normal") == "off");
  CHECK(all[5].get("r0") == "8px");
  CHECK(all[5].get("gloss") == "off");
  CHECK(psf::Parameters::combinations({}).size() == 1);
  CHECK(psf::Parameters::combinations({{"r0", psf::tune_radii()}}).size() == 9);
  CHECK_THROWS_WITH(psf::Parameters::combinations({{"r0", "2px,,4px"}}),
                    StartsWith("`r0`: '2px,,4px' has an empty value"));
  CHECK_THROWS_WITH(psf::Parameters::combinations({{"r1", "2"}}),
                    StartsWith("there is no parameter 'r1'"));
}

TEST_CASE("tuning chooses the least error and gives parameters to filter with") {
  const TempFolder folder;
  psf::tests::write(folder / "a.pvb", Plane(8), 8);
  const psf::Dump dump(folder / "a.pvb");
  const psf::TuneResult tuned = dump.tune(sets("1px,4px"));
  REQUIRE(tuned.rows.size() == 2);
  CHECK(tuned.rows[0].error < tuned.rows[1].error);
  CHECK(tuned.best.get("r0") == "4px");
  CHECK(tuned.best.get("block") == "1pass");
  CHECK(tuned.unfiltered > tuned.rows[0].error);
  CHECK(tuned.notes.size() == 1);  // no visibility, no directions for gloss
  CHECK_THAT(tuned.json, StartsWith("{\n \"kind\": \"tune\""));
  CHECK(dump.filter(tuned.best).pictures.size() == 1);
  tuned.save(folder / "tuned.json");
  CHECK(psf::tests::read_text(folder / "tuned.json") == tuned.json);
  CHECK_THROWS_WITH(tuned.save(folder / "a.pvb"), ContainsSubstring("overwrite the input"));
  CHECK_THROWS_WITH(dump.tune({}), StartsWith("`sets`"));
  psf::TuneOptions other;
  other.camera = 1;
  CHECK_THROWS_WITH(dump.tune(sets("1px"), other), StartsWith("`camera`: there is no camera 1"));
}

TEST_CASE("convergence has a row for each set and n, the errors of filter runs") {
  const TempFolder folder;
  std::vector<std::string> dumps;
  for (unsigned seed = 0; seed < 3; ++seed) {
    dumps.push_back(folder / std::to_string(seed) + ".pvb");
    psf::tests::write(dumps.back(), Plane(4, seed), 4, seed);
  }
  const psf::Dump first(dumps[0]);
  const psf::Picture reference = first.filter(sets("6px")[0]).pictures[0];
  psf::ConvergeOptions options;
  options.times = false;
  const psf::ConvergeResult study = psf::converge(dumps, reference, sets("2px,4px"), options);
  REQUIRE(study.rows.size() == 3 * 3);
  CHECK(study.rows[0].id == "unfiltered");
  CHECK(study.rows[0].parameters.empty());
  CHECK(study.rows[8].parameters[0] == std::pair<std::string, std::string>("r0", "4px"));
  CHECK(study.rows[8].n == 4);
  CHECK(std::isnan(value(study.rows[8], "slope_variance")));
  double mean = 0;
  for (const std::string& path : dumps) {
    mean += psf::Dump(path).filter(sets("4px")[0]).pictures[0].error(reference) / 3;
  }
  CHECK(value(study.rows[8], "relMSE") == Approx(mean).epsilon(1e-5));
  CHECK_THAT(study.csv, StartsWith("id,r0,delta,"));
  CHECK_THAT(study.json, StartsWith("{\n \"kind\": \"converge\""));
  study.save(folder / "study");
  CHECK(psf::tests::read_text(folder / "study/converge.json") == study.json);
  CHECK(psf::tests::read_text(folder / "study/converge.csv") == study.csv);
  CHECK_THROWS_WITH(study.save(folder / "study"), ContainsSubstring("is there already"));
  options.render_json = {R"({"passes": 4})"};
  CHECK_THROWS_WITH(psf::converge(dumps, reference, sets("2px"), options),
                    StartsWith("`render_json`: has no number 'output_seconds'"));
}

TEST_CASE("an explanation outlives its dump, and writes JSON and a point cloud") {
  const TempFolder folder;
  psf::tests::write(folder / "a.pvb", Plane(2), 2);
  const psf::Explanation why = [&] {
    const psf::Dump dump(folder / "a.pvb");
    CHECK_THROWS_WITH(dump.explain(kSide, 0), ContainsSubstring("24,0"));
    return dump.explain(3, 5);
  }();
  CHECK_THAT(why.text(), ContainsSubstring("pixel 3,5 of camera \"above\""));
  CHECK(why.whole_text().size() > why.text().size());
  CHECK(why.notes().size() == 1);
  why.save(folder / "why.json");
  CHECK(psf::tests::read_text(folder / "why.json") == why.json());
  why.save(folder / "why.ply");
  CHECK_THAT(psf::tests::read_text(folder / "why.ply"), StartsWith("ply\n"));
  CHECK_THROWS_WITH(why.save(folder / "why.txt"), ContainsSubstring(".json or .ply"));
  std::filesystem::create_symlink("a.pvb", folder / "dump.json");
  CHECK_THROWS_WITH(why.save(folder / "dump.json"), ContainsSubstring("overwrite the input"));
}

TEST_CASE("a call is ended by its own thread's word alone") {
  const TempFolder folder;
  psf::tests::write(folder / "a.pvb", Plane(2), 2);
  const psf::Dump dump(folder / "a.pvb");
  const std::atomic<bool> stopped{true};
  {
    const psf::Interruptible here(stopped);
    CHECK_THROWS_WITH(dump.filter(), StartsWith("interrupted"));
    std::size_t pictures = 0;
    std::thread([&] { pictures = dump.filter().pictures.size(); }).join();
    CHECK(pictures == 1);
  }
  CHECK(dump.filter().pictures.size() == 1);
}
