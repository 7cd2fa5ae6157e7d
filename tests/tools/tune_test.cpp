// psf tune as a program: its choice is near the best of the grid, and psf filter takes it.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

const std::string kScenes = PSF_SOURCE_DIR "/tests/tools/scenes/";

struct Choice {
  double ratio;  // its error over the least error of the grid
  bool sure;
};

void render(const std::string& scene, std::size_t size, const std::string& arguments) {
  const std::string pixels = std::to_string(size);
  const Outcome outcome = run("psf-render " + scene + ".json --quiet --size " + pixels + "x" +
                              pixels + " " + arguments);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
}

Choice choose(const std::string& scene, std::size_t size, int seed, const std::string& reference) {
  const TempFolder folder;
  render(scene, size, "--passes 16 --seed " + std::to_string(seed) + " -o " + folder / "a.pvb");
  Outcome outcome = run("psf sweep " + folder / "a.pvb --quiet --reference " + reference + kGrid +
                        " -o " + folder / "out");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  outcome = run("psf tune " + folder / "a.pvb --quiet" + kGrid + " --json " + folder / "t.json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json tuned = json::parse(read_text(folder / "t.json"));
  const json sweep = json::parse(read_text(folder / "out/sweep.json"));
  double least = 1e9, of_choice = 0;
  for (const json& row : sweep.at("rows")) {
    const double error = row.at("metrics").at("relMSE");
    least = std::min(least, error);
    if (row.at("parameters") == tuned.at("best").at("parameters")) of_choice = error;
  }
  REQUIRE(of_choice > 0);
  return {of_choice / least, tuned.at("sure")};
}

}  // namespace

TEST_CASE("The choice of psf tune is near the best of the grid") {
  CHECK(choose(kSamples + "cornell", 256, 0, kSamples + "cornell-reference.exr").ratio <= 1.15);
  CHECK(choose(kSamples + "arcade", 256, 0, kSamples + "arcade-reference.exr").ratio <= 1.15);
}

TEST_CASE("Neither the rim of a lamp nor fireflies mislead psf tune") {
  for (const std::string scene : {"lamp-gap", "glossy-boxes", "textured-metal"}) {
    const TempFolder folder;
    render(kScenes + scene, 64, "--passes 256 --seed 77 --image " + folder / "r.exr");
    INFO(scene);
    CHECK(choose(kScenes + scene, 64, 1, folder / "r.exr").ratio <= 1.15);
  }
}

// Prints the table of src/study/README.md.
TEST_CASE("The choice of psf tune is near the best of the grid, or it is not sure", "[.][long]") {
  std::vector<std::string> scenes;
  for (const char* name : {"lamp-gap", "glossy-boxes", "textured-metal"}) {
    scenes.push_back(kScenes + name);
  }
  for (const char* name : {"cornell", "arcade", "textured", "two-rooms", "materials", "fence",
                           "corner", "sphere-light", "furnace"}) {
    scenes.push_back(kSamples + name);
  }
  for (const std::string& scene : scenes) {
    std::string line;
    for (const std::size_t size : {std::size_t{128}, std::size_t{256}}) {
      const TempFolder folder;
      render(scene, size, "--passes 1024 --seed 77 --image " + folder / "r.exr");
      for (const int seed : {1, 2}) {
        const Choice choice = choose(scene, size, seed, folder / "r.exr");
        INFO(scene << ", " << size << " pixels, seed " << seed << ", ratio " << choice.ratio);
        CHECK((choice.ratio <= 1.15 || !choice.sure));
        line += fmt::format(" {:.2f}{}", choice.ratio, choice.sure ? " sure" : "");
      }
    }
    WARN(scene << line);
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
