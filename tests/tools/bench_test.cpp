// psf-bench as a user meets it: a tiny run, and what a program reads of it.
#include "bench_report.h"
#include "catch.h"
#include "command.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::rows_of;
using psf::tests::run;
using psf::tests::TempFolder;

TEST_CASE("psf-bench files measures a made-up dump and leaves nothing behind") {
  const TempFolder folder;
  const std::string json = folder / "bench.json";
  const Outcome outcome = run("psf-bench files --records 3000 --repeat 3 --threads 1 --temp " +
                              folder.path().string() + " --json " + json);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(folder.file_count() == 1);
  const auto report = nlohmann::json::parse(read_text(json));
  CHECK(report.at("records") == 3000);
  CHECK(report.at("repeat") == 3);
  CHECK(report.at("page_cache") == "warm");
  const auto rows = rows_of(report);
  CHECK(rows.size() == 8);
  for (const auto& [name, row] : rows) {
    INFO(name);
    CHECK(row.at("median") > 0);
    CHECK(row.at("min") <= row.at("median"));
    CHECK(row.at("median") <= row.at("max"));
    CHECK(outcome.out.find(row.at("what").get<std::string>()) != std::string::npos);
  }
  // A file of one small chunk is mostly padding and head: this target is missed, and that is said.
  CHECK(rows.at("raw_overhead").at("met") == false);
  CHECK(outcome.out.find("MISSED") != std::string::npos);
  CHECK_FALSE(rows.at("zstd_size").contains("target"));
  CHECK(run("psf-bench files --records 3000 --repeat 1 --check").code == 1);
}

TEST_CASE("psf-bench files takes a dump, and a scene to render") {
  const TempFolder folder;
  const std::string json = folder / "bench.json";
  const std::string data = PSF_SOURCE_DIR "/sample_data/";
  const Outcome outcome =
      run("psf-bench files " + data + "golden-zstd.pvb --repeat 1 --passes 1 --scene " + data +
          "furnace.json --json " + json);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto report = nlohmann::json::parse(read_text(json));
  CHECK(report.at("records") == 48);
  const auto rows = rows_of(report);
  CHECK(rows.contains("write_processor"));
  CHECK(rows.at("write_waiting").at("median") > 0);
  CHECK(rows.at("zstd_size").contains("target"));
}

TEST_CASE("psf-bench tells wrong use in one line with the right code") {
  CHECK(run("psf-bench files nowhere.pvb").code == 4);
  CHECK(run("psf-bench files --repeat 0").code == 2);
  CHECK(run("psf-bench files --temp /nowhere").code == 4);
  CHECK(run("psf-bench").code == 2);
  const Outcome scene = run("psf-bench files --records 100 --repeat 1 --scene nowhere.json");
  CHECK(scene.code == 3);
  CHECK(scene.err.find("nowhere.json") != std::string::npos);
}

TEST_CASE("psf-bench sweep measures pairs of r0 and delta against one run") {
  const TempFolder folder;
  const std::string dump = folder / "a.pvb", json = folder / "bench.json";
  REQUIRE(run("psf-render " PSF_SOURCE_DIR "/sample_data/cornell.json --quiet --size 32x32 "
              "--passes 4 -o " +
              dump)
              .code == 0);
  const Outcome outcome = run("psf-bench sweep " + dump + " --r0 4px --repeat 1 --json " + json);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto rows = rows_of(nlohmann::json::parse(read_text(json)));
  CHECK(rows.at("pairs_4px").at("median") > 0);
  CHECK(rows.at("difference_4px").at("median") < 1e-5);
}
