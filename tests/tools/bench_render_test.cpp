// psf-bench render as a user meets it: tiny runs, and what a program reads of them.
#include "bench_report.h"
#include "catch.h"
#include "command.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::rows_of;
using psf::tests::run;
using psf::tests::TempFolder;

TEST_CASE("psf-bench render replays every ray of a render") {
  const TempFolder folder;
  const std::string json = folder / "bench.json", data = PSF_SOURCE_DIR "/sample_data/";
  // Spheres and meshes, instances, masks, and shapes that move.
  for (const std::string scene : {"cornell", "tree", "surfaces", "lantern"}) {
    CAPTURE(scene);
    const Outcome outcome = run("psf-bench render " + data + scene +
                                ".json --size 18x16 --passes 1 --repeat 1 --json " + json);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK(outcome.err.empty());
    const auto report = nlohmann::json::parse(read_text(json));
    const auto rows = rows_of(report);
    CHECK(rows.at("rays_1").at("median") > 0);
    CHECK(rows.at("rays_1").at("target").at("value") == 0.7);
    CHECK(rows.at("packets_8").at("median") > 0);
    CHECK(rows.at("packets_16").at("median") > 0);
    CHECK(report.at("rays") > 18 * 16);
    // The rays of a render are those that psf-render counts.
    const std::string render = folder / "render.json";
    REQUIRE(run("psf-render " + data + scene + ".json --size 18x16 --passes 1 --quiet --image " +
                (folder / "a.exr") + " --json " + render)
                .code == 0);
    CHECK(report.at("rays") == nlohmann::json::parse(read_text(render)).at("rays"));
    CHECK(outcome.out.find("bare Embree, 1 thread ") != std::string::npos);
  }
}

TEST_CASE("psf-bench render tells wrong use in one line with the right code") {
  const std::string cornell = PSF_SOURCE_DIR "/sample_data/cornell.json";
  CHECK(run("psf-bench render nowhere.json").code == 4);
  CHECK(run("psf-bench render " PSF_SOURCE_DIR "/README.md").code == 3);
  CHECK(run("psf-bench render " + cornell + " --size big").code == 2);
  CHECK(run("psf-bench render " + cornell + " --passes 0").code == 2);
  const Outcome many = run("psf-bench render " + cornell + " --size 4096x4096 --passes 2");
  CHECK(many.code == 5);
  CHECK(many.err.find("cornell.json: ") != std::string::npos);
  CHECK(many.err.find("fewer --passes") != std::string::npos);
}
