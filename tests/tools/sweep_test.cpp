// psf sweep as a program: rows are what psf filter gives, nothing done is done twice.
#include <filesystem>
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

const std::string kCornell = PSF_SOURCE_DIR "/sample_data/cornell.json";

class Swept {
 public:
  Swept() {
    render("a.pvb", "--passes 4 --seed 1", "a.exr");
    render("b.pvb", "--passes 16 --seed 2", "reference.exr");
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] Outcome sweep(const std::string& options) const {
    return run("psf sweep " + folder_ / "a.pvb" + " --quiet --reference " +
               folder_ / "reference.exr" + " -o " + folder_ / "out " + options);
  }
  [[nodiscard]] json rows() const { return document().at("rows"); }
  [[nodiscard]] json document() const { return json::parse(read_text(folder_ / "out/sweep.json")); }

 private:
  void render(const std::string& name, const std::string& options, const std::string& image) const {
    const Outcome outcome = run("psf-render " + kCornell + " --quiet --size 40x30 " + options +
                                " -o " + folder_ / name + " --image " + folder_ / image);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
  }

  TempFolder folder_;
};

}  // namespace

TEST_CASE("A row of a sweep is what psf filter and psf compare give") {
  const Swept work;
  const Outcome outcome = work.sweep(
      "--pictures --r0 2px:8px:x2 --delta 0,0.5 --block 1pass,all --normal 0.9,off --visibility "
      "off");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json document = work.document();
  REQUIRE(document.at("rows").size() == 24);
  for (const json& row : document.at("rows")) {
    const json& p = row.at("parameters");
    const auto text = [&](const char* name) { return p.at(name).get<std::string>(); };
    const Outcome filtered =
        run("psf filter " + work / "a.pvb" + " --quiet -o " + work / "f.exr" + " --json " +
            work / "f.json" + " --r0 " + text("r0") + " --delta " + text("delta") + " --block " +
            text("block") + " --normal " + text("normal") + " --visibility=off");
    REQUIRE(filtered.code == 0);
    const auto a = psf::film::read_exr(work / "f.exr").rgb();
    const auto b = psf::film::read_exr(work / "out/" + row.at("picture").get<std::string>()).rgb();
    CHECK(psf::tests::largest_difference(b, a) < 1e-5);
    const json figures = json::parse(read_text(work / "f.json"));
    CHECK(row.at("neighbors") == figures.at("neighbors").at("mean"));
    for (const bool own : {true, false}) {
      const std::string picture =
          own ? "out/" + row.at("picture").get<std::string>() : std::string("f.exr");
      const Outcome compared = run("psf compare " + work / picture + " " + work / "reference.exr" +
                                   " --json " + work / "c.json");
      REQUIRE(compared.code == 0);
      const json values = json::parse(read_text(work / "c.json")).at("rows").at(0).at("metrics");
      REQUIRE(values.size() == 7);
      for (const auto& [name, value] : values.items()) {
        INFO(picture << " " << name);
        // The value is that of the row's own picture to the last bit.
        const double expected = value.get<double>(), got = row.at("metrics").at(name);
        if (own) CHECK(got == expected);
        CHECK(got == Approx(expected).epsilon(1e-3));
      }
    }
  }
  CHECK(document.at("unfiltered").at("metrics").at("relMSE") > 0);
  const std::string csv = read_text(work / "out/sweep.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 25);
}

TEST_CASE("A sweep that is resumed keeps its rows and does the missing ones") {
  const Swept work;
  REQUIRE(work.sweep("--r0 2px,4px").code == 0);
  const json before = work.rows();
  const Outcome refused = work.sweep("--r0 2px");
  CHECK(refused.code == 2);
  CHECK(refused.err.find("--resume") != std::string::npos);
  REQUIRE(work.sweep("--resume --r0 2px:8px:x2").code == 0);
  const json after = work.rows();
  REQUIRE(after.size() == 3);
  CHECK(after[0] == before[0]);
  CHECK(after[1] == before[1]);
  CHECK(after[2].at("parameters").at("r0") == "8px");
  const Outcome other = run("psf sweep " + work / "b.pvb" + " --quiet --reference " +
                            work / "reference.exr" + " -o " + work / "out --resume --r0 2px");
  CHECK(other.code == 3);
  CHECK(other.err.find("another dump") != std::string::npos);
}

TEST_CASE("A sweep says what is wrong with its lists") {
  const Swept work;
  const auto refused = [&](const std::string& options, const std::string& what) {
    const Outcome outcome = work.sweep(options);
    INFO(options << ": " << outcome.err);
    CHECK(outcome.code == 2);
    CHECK(outcome.err.find(what) != std::string::npos);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  };
  refused("--r0 2px:8px", "three parts");
  refused("--r0 2px:8wu:x2", "units differ");
  refused("--r0 8px:2px:x2", "ends before");
  refused("--r0 2px:8px:x1", "factor");
  refused("--delta 0:1:0", "step");
  refused("--delta 0.2,,0.3", "empty");
  refused("--delta 1.5", "delta");
  refused("--delta 0:0.9:0.0001", "1,000");
  refused("--visibility maybe", "neither on nor off");
  refused("--estimator magic", "magic");
  refused("--delta 0:0.9:0.001 --r0 1px:900px:1px", "combinations");
  refused("--camera none", "front");
}

TEST_CASE("A sweep takes a layer of its reference") {
  const Swept work;
  const psf::film::Image reference = psf::film::read_exr(work / "reference.exr");
  psf::film::Image layers;
  layers.width = reference.width;
  layers.height = reference.height;
  for (const char* channel : {"R", "G", "B"}) {
    const std::vector<float>& values = *reference.find(channel);
    layers.layers.push_back({std::string("beauty.") + channel, values});
    layers.layers.push_back(
        {std::string("black.") + channel, std::vector<float>(values.size(), 0.0f)});
  }
  REQUIRE(work.sweep("--r0 2px").code == 0);
  const json expected = work.rows()[0].at("metrics");
  psf::film::write_exr(work / "reference.exr", layers);
  const Outcome several = work.sweep("--r0 2px");
  CHECK(several.code == 2);
  CHECK(several.err.find("give --reference-layer one of: beauty, black\n") != std::string::npos);
  std::filesystem::remove_all(work / "out");
  REQUIRE(work.sweep("--r0 2px --reference-layer beauty").code == 0);
  CHECK(work.rows()[0].at("metrics") == expected);
}
