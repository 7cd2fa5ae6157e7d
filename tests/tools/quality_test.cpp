// What the filter is worth: the error of the filtered picture against a reference of 4,096 passes,
// at most a given fraction of the unfiltered one's, with the default parameters for every scene.
// 256 x 256, 16 passes, path.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "catch.h"
#include "command.h"
#include "shared_scenes.h"

namespace fs = std::filesystem;
using psf::tests::Outcome;
using psf::tests::run;
using psf::tests::shared_scenes;
using psf::tests::TempFolder;

namespace {

const std::string kSamples = PSF_SOURCE_DIR "/sample_data/";

Outcome run_well(const std::string& command) {
  Outcome outcome = run(command);
  INFO(command << "\n" << outcome.err);
  REQUIRE(outcome.code == 0);
  return outcome;
}

double relative_mse(const std::string& picture, const std::string& reference) {
  const Outcome outcome = run_well("psf compare " + picture + " " + reference);
  REQUIRE(outcome.out.starts_with("relMSE "));
  return std::atof(outcome.out.c_str() + 7);
}

// How many times the filter takes the error down.
double gain(const std::string& scene, const std::string& reference) {
  const TempFolder folder;
  const std::string dump = folder / "dump.pvb", before = folder / "before.exr",
                    after = folder / "after.exr";
  run_well("psf-render " + scene + " --size 256x256 --passes 16 --quiet -o " + dump + " --image " +
           before);
  run_well("psf filter " + dump + " --quiet -o " + after);
  return relative_mse(before, reference) / relative_mse(after, reference);
}

}  // namespace

TEST_CASE("Cornell box: at most a fifteenth of the error is left") {
  CHECK(gain(kSamples + "cornell.json", kSamples + "cornell-reference.exr") >= 15);
}

TEST_CASE("arcade: at most an eighth of the error is left") {
  CHECK(gain(kSamples + "arcade.json", kSamples + "arcade-reference.exr") >= 8);
}

TEST_CASE("Glossy surfaces at the first hit: the filter does not lose to none") {
  const TempFolder folder;
  const std::string scene =
      "psf-render " + kSamples + "materials.json --size 64x64 --quiet " + "--vertex-roughness 0 ";
  const std::string dump = folder / "dump.pvb", reference = folder / "reference.exr";
  run_well(scene + "--passes 256 --seed 1 --image " + reference + " -o " + folder / "other.pvb");
  run_well(scene + "--passes 16 -o " + dump + " --image " + folder / "before.exr");
  const double before = relative_mse(folder / "before.exr", reference);
  const auto after = [&](const std::string& options) {
    run_well("psf filter " + dump + " --quiet -o " + folder / "after.exr" + options);
    return relative_mse(folder / "after.exr", reference);
  };
  CHECK(after("") < before);
  CHECK(after(" --gloss off") > before);
}

TEST_CASE("Sponza with sky and sun: at most a fifth of the error is left", "[.][long]") {
  const std::string scenes = shared_scenes();
  if (scenes.empty()) SKIP("no folder of shared scenes; name it in PSF_SCENES");
  const TempFolder folder;
  const std::string reference = folder / "reference.exr";
  const std::string scene =
      scenes +
      "/sponza/sponza.obj --eye 14.4499,6.89415,-1.18547 --target 13.4563,6.78438,-1.15861 "
      "--fov 90.47 --sky 1,1,1 --sun 0.2,1,0.15 --sun-irradiance 10,9,8";
  run_well("psf-render " + scene + " --size 256x256 --passes 4096 --seed 1 --quiet --image " +
           reference);
  CHECK(gain(scene, reference) >= 5);
}
