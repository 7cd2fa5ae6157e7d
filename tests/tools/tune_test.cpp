// psf tune as a program: its choice is near the best of the grid, and psf filter takes it.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.h"
#include "command.h"
#include "film/image.h"

using nlohmann::json;
using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

const std::string kSamples = PSF_SOURCE_DIR "/sample_data/";
const std::string kGrid = " --r0 2px,2.8px,4px,5.7px,8px,11.3px,16px,22.6px,32px --delta 0.2,0.333";

// Error of the choice over the least error of the grid.
double ratio(const std::string& scene, const std::string& reference) {
  const TempFolder folder;
  Outcome outcome = run("psf-render " + kSamples + scene +
                        ".json --quiet --size 256x256 --passes 16 -o " + folder / "a.pvb");
  REQUIRE(outcome.code == 0);
  outcome = run("psf sweep " + folder / "a.pvb --quiet --reference " + reference + kGrid + " -o " +
                folder / "out");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  outcome = run("psf tune " + folder / "a.pvb --quiet" + kGrid + " --json " + folder / "t.json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json chosen = json::parse(read_text(folder / "t.json")).at("best").at("parameters");
  double least = 1e9, of_choice = 0;
  const json sweep = json::parse(read_text(folder / "out/sweep.json"));
  for (const json& row : sweep.at("rows")) {
    const double error = row.at("metrics").at("relMSE");
    least = std::min(least, error);
    if (row.at("parameters") == chosen) of_choice = error;
  }
  REQUIRE(of_choice > 0);
  return of_choice / least;
}

}  // namespace

TEST_CASE("The choice of psf tune is near the best of the grid") {
  CHECK(ratio("cornell", kSamples + "cornell-reference.exr") <= 1.15);
  CHECK(ratio("arcade", kSamples + "arcade-reference.exr") <= 1.15);
}

TEST_CASE("The choice of psf tune is near the best of the grid on every sample scene",
          "[.][long]") {
  for (const std::string scene :
       {"textured", "two-rooms", "materials", "fence", "corner", "sphere-light", "furnace"}) {
    const TempFolder folder;
    const Outcome outcome =
        run("psf-render " + kSamples + scene +
            ".json --quiet --size 256x256 --passes 1024 --seed 77 --image " + folder / "r.exr");
    REQUIRE(outcome.code == 0);
    INFO(scene);
    CHECK(ratio(scene, folder / "r.exr") <= 1.15);
  }
}

TEST_CASE("psf filter takes what psf tune chose, and no other parameters beside") {
  const TempFolder folder;
  REQUIRE(run("psf-render " + kSamples + "cornell.json --quiet --size 40x30 --passes 4 -o " +
              folder / "a.pvb")
              .code == 0);
  const Outcome tuned = run("psf tune " +
                            folder /
                                "a.pvb --quiet --r0 3px --delta 0.4 --block "
                                "1pass --normal 0.9 --visibility off --json " +
                            folder / "t.json");
  INFO(tuned.err);
  REQUIRE(tuned.code == 0);
  CHECK(tuned.out.find("not independent") != std::string::npos);
  const std::string filter = "psf filter " + folder / "a.pvb --quiet -o ";
  REQUIRE(run(filter + folder / "a.exr --tuned " + folder / "t.json").code == 0);
  REQUIRE(run(filter + folder / "b.exr --r0 3px --delta 0.4 --block 1pass --normal 0.9 "
                                "--visibility=off")
              .code == 0);
  CHECK(psf::film::read_exr(folder / "a.exr").rgb() == psf::film::read_exr(folder / "b.exr").rgb());
  const Outcome both = run(filter + folder / "c.exr --r0 3px --tuned " + folder / "t.json");
  CHECK(both.code == 2);
  const Outcome wrong = run(filter + folder / "c.exr --tuned " + folder / "a.pvb");
  CHECK(wrong.code == 3);
  CHECK(wrong.err.find("psf tune --json") != std::string::npos);
}
