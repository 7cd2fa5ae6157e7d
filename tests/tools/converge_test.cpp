// psf converge as a program: points are what psf filter gives, slopes are those of theory.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.h"
#include "command.h"
#include "film/image.h"
#include "picture_difference.h"

using nlohmann::json;
using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::run;
using psf::tests::TempFolder;

namespace {

void render(const std::string& options) {
  const Outcome outcome =
      run("psf-render " PSF_SOURCE_DIR "/sample_data/cornell.json --quiet --size 40x30 " + options);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
}

}  // namespace

TEST_CASE("A point of a convergence study is what psf filter gives of the first passes") {
  const TempFolder folder;
  for (const std::string seed : {"1", "2", "3"}) {
    render("--passes 6 --seed " + seed + " -o " + folder / seed + ".pvb --json " + folder / seed +
           ".json");
  }
  render("--passes 32 --seed 9 --image " + folder / "reference.exr");
  const Outcome outcome =
      run("psf converge " + folder / "1.pvb " + folder / "2.pvb " + folder / "3.pvb" +
          " --quiet --reference " + folder / "reference.exr" + " --r0 4px,8px --delta 0.5 -o " +
          folder / "out --pictures --render-json " + folder / "1.json --render-json " +
          folder / "2.json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json document = json::parse(read_text(folder / "out/converge.json"));
  CHECK(document.at("n") == json({1, 2, 4, 6}));
  REQUIRE(document.at("series").size() == 3);
  for (const json& series : document.at("series")) {
    for (const json& point : series.at("points")) {
      const std::string n = std::to_string(point.at("n").get<int>());
      const bool filtered = !series.at("parameters").is_null();
      const std::string r0 = filtered ? series.at("parameters").at("r0").get<std::string>() : "0px";
      INFO("r0 " << r0 << ", n " << n);
      const Outcome one = run("psf filter " + folder / "1.pvb --quiet --delta 0.5 --r0 " + r0 +
                              " --passes 0:" + n + " -o " + folder / "f.exr");
      REQUIRE(one.code == 0);
      const auto a = psf::film::read_exr(folder / "f.exr").rgb();
      const auto b =
          psf::film::read_exr(folder / "out/" + point.at("picture").get<std::string>()).rgb();
      CHECK(psf::tests::largest_difference(b, a) < 1e-5);
      CHECK(point.at("mse").get<double>() ==
            Approx(point.at("metrics").at("relMSE").get<double>()).epsilon(1e-6));
      CHECK(point.at("mse").get<double>() ==
            Approx(point.at("bias_sq").get<double>() + point.at("variance").get<double>()));
      CHECK(point.at("bias_sq_ci")[0] <= point.at("bias_sq"));
      CHECK(point.at("seconds").at("render") > 0);
    }
  }
  CHECK(document.at("speedups").size() == 8);
  CHECK(outcome.out.find("equal time") != std::string::npos);
}

TEST_CASE("A convergence study refuses what are no replicates") {
  const TempFolder folder;
  render("--passes 2 --seed 1 -o " + folder / "a.pvb --image " + folder / "a.exr");
  render("--passes 1 --seed 2 -o " + folder / "b.pvb");
  const auto study = [&](const std::string& dumps) {
    return run("psf converge " + dumps + " --quiet --reference " + folder / "a.exr -o " +
               folder / "out");
  };
  const Outcome same = study(folder / "a.pvb " + folder / "a.pvb");
  CHECK(same.code == 3);
  CHECK(same.err.find("seed") != std::string::npos);
  const Outcome few = study(folder / "a.pvb " + folder / "b.pvb");
  CHECK(few.code == 2);
  CHECK(few.err.find("passes") != std::string::npos);
  json scene = json::parse(read_text(PSF_SOURCE_DIR "/sample_data/cornell.json"));
  scene["cameras"].push_back(scene["cameras"][0]);
  scene["cameras"][1]["name"] = "side";
  std::ofstream(folder / "two.json") << scene;
  const std::string two =
      "psf-render " + folder / "two.json" + " --quiet --size 16x12 --passes 2 --camera ";
  REQUIRE(run(two + "front --camera side -o " + folder / "both.pvb").code == 0);
  REQUIRE(run(two + "front --seed 3 -o " + folder / "one.pvb").code == 0);
  REQUIRE(run(two + "side --image " + folder / "b.exr").code == 0);
  const Outcome fewer =  // the second dump does not even have the camera that is asked for
      run("psf converge " + folder / "both.pvb " + folder / "one.pvb --quiet --camera side " +
          "--reference " + folder / "b.exr -o " + folder / "out");
  CHECK(fewer.code == 3);
  CHECK(fewer.err.find("one.pvb: is of another scene or camera") != std::string::npos);
  const Outcome nothing = run("psf converge -o " + folder / "out");
  CHECK(nothing.code == 2);
  CHECK(nothing.err.find("--analytic") != std::string::npos);
  const Outcome ignored = run("psf converge --analytic --block 2passes -o " + folder / "out");
  CHECK(ignored.code == 2);
  CHECK(ignored.err.find("--block") != std::string::npos);
}

TEST_CASE("The built-in scenes overwrite nothing, and say so before they are studied") {
  const TempFolder folder;
  const std::string line = "psf converge --analytic -o " + folder / "out --json ";
  const Outcome own = run(line + folder / "out/smooth/converge.json");
  CHECK(own.code == 2);
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
  CHECK(run(line + folder / "none/all.json").code == 4);
  std::filesystem::create_directories(folder / "out/edge");
  std::ofstream(folder / "out/edge/converge.json") << "mine";
  const Outcome there = run(line + folder / "all.json");
  CHECK(there.code == 2);
  CHECK(there.err.find("is there already") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "out/smooth"));
}

TEST_CASE("On the built-in scenes the slopes are those of theory") {
  const TempFolder folder;
  const Outcome outcome = run("psf converge --analytic --quiet --delta 0.333333,0.5 -o " +
                              folder / "out --json " + folder / "all.json");
  INFO(outcome.out << outcome.err);
  CHECK(outcome.code == 0);
  CHECK(outcome.out.find("FAILED") == std::string::npos);
  CHECK(json::parse(read_text(folder / "out/edge/converge.json")).at("analytic").at("passed") ==
        true);
  CHECK(json::parse(read_text(folder / "all.json")).at("edge") ==
        json::parse(read_text(folder / "out/edge/converge.json")));
  CHECK_FALSE(std::filesystem::exists(folder / "out/edge/0.pvb"));
}
