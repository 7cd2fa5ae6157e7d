// psf-bench filter as a user meets it: tiny runs, and what a program reads of them.
#include <fmt/format.h>

#include "bench_report.h"
#include "catch.h"
#include "command.h"

using psf::tests::Outcome;
using psf::tests::read_text;
using psf::tests::rows_of;
using psf::tests::run;
using psf::tests::TempFolder;
using Json = nlohmann::json;

namespace {

Json points_of(const Json& report, const std::string& series) {
  Json points = Json::array();
  for (const Json& point : report.at("points")) {
    if (point.at("series") == series) points.push_back(point);
  }
  return points;
}

}  // namespace

TEST_CASE("psf-bench filter measures a made-up box") {
  const TempFolder folder;
  const std::string json = folder / "bench.json";
  const Outcome outcome =
      run("psf-bench filter --records 20000 --neighbors 20,35 --repeat 3 --quiet --json " + json);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.empty());
  CHECK(folder.file_count() == 1);
  const Json report = Json::parse(read_text(json));
  CHECK(report.at("benchmark") == "filter");
  CHECK(report.at("records") == 20000);
  CHECK(report.at("parameters").at("visibility") == "on");
  CHECK(report.at("left_out").empty());
  const auto rows = rows_of(report);
  for (const auto& [name, row] : rows) {
    INFO(name);
    CHECK(row.at("min") <= row.at("median"));
    CHECK(row.at("median") <= row.at("max"));
    CHECK(outcome.out.find(row.at("what").get<std::string>()) != std::string::npos);
  }
  CHECK_FALSE(rows.at("speed_20").contains("target"));
  CHECK(rows.at("speed_35").at("target").at("value") == 8);
  CHECK(rows.at("neighbors_differ").at("median") == 0);
  CHECK(rows.at("c_bar_differs").at("met") == true);
  for (const char* name : {"passes_2x", "floor_chi", "floor_terms", "floor_share"}) {
    CHECK(rows.at(name).at("median") > 0);
  }
  // What the machine has beside its best set is on the floor and in the whole filter.
  std::size_t on_floor = 0, whole = 0;
  for (const auto& [name, row] : rows) {
    if (name.starts_with("floor_terms_")) ++on_floor;
    if (name.starts_with("set_")) ++whole;
  }
  CHECK(on_floor == whole);

  const Json points = points_of(report, "speed");
  REQUIRE(points.size() == 4);  // two engines for each number of neighbours
  for (std::size_t k = 0; k < 4; ++k) {
    const Json& point = points[k];
    CHECK(point.at("search") == (k % 2 == 0 ? "plain" : "flann"));
    CHECK(point.at("neighbors").get<double>() == Approx(k < 2 ? 20 : 35).epsilon(0.02));
    CHECK(point.at("in_ball") > point.at("neighbors"));
    CHECK(point.at("runs") == 3);
    const double seconds = point.at("seconds").at("median");
    CHECK(point.at("ns_per_record").get<double>() == Approx(seconds * 1e9 / 20000));
  }
  CHECK(points[0].at("r0") < points[2].at("r0"));
}

TEST_CASE("psf-bench filter finds the radius that gives psf filter as many neighbours") {
  const TempFolder folder;
  const std::string dump = folder / "room.pvb", json = folder / "bench.json";
  REQUIRE(run("psf-render " PSF_SOURCE_DIR "/sample_data/cornell.json --size 64x64 --passes 2 -o " +
              dump)
              .code == 0);
  const Outcome outcome =
      run("psf-bench filter " + dump +
          " --records 8192 --neighbors 30 --repeat 1 --threads 1 --json " + json);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const Json report = Json::parse(read_text(json));
  CHECK(report.at("input") == dump);
  CHECK(report.at("threads") == 1);
  CHECK_FALSE(rows_of(report).contains("threads_2"));
  const Json point = points_of(report, "speed").at(0);
  REQUIRE(report.at("parameters").at("r0_unit") == "px");
  REQUIRE(run(fmt::format("psf filter {} -o {} --r0 {}px --delta 0 --block all --json {}", dump,
                          folder / "room.exr", point.at("r0").get<double>(), json))
              .code == 0);
  const Json filtered = Json::parse(read_text(json));
  CHECK(filtered.at("neighbors").at("mean").get<double>() == point.at("neighbors").get<double>());
}

TEST_CASE("psf-bench filter shows growth and what it leaves out") {
  const TempFolder folder;
  const std::string json = folder / "bench.json";
  const Outcome outcome =
      run("psf-bench filter --records 1500 --neighbors 9,5000 --repeat 1 --growth "
          "--growth-records 70000 --json " +
          json);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const Json report = Json::parse(read_text(json));
  CHECK_FALSE(rows_of(report).contains("speed_5000"));
  CHECK(report.at("left_out").at(0).get<std::string>().starts_with("5000 neighbours"));
  const Json neighbors = points_of(report, "neighbors"), records = points_of(report, "records");
  REQUIRE(neighbors.size() >= 3);
  CHECK(neighbors[2].at("neighbors").get<double>() == Approx(100).epsilon(0.02));
  REQUIRE(records.size() == 2);
  CHECK(records[1].at("records") == 1 << 16);
  CHECK(records[1].at("neighbors").get<double>() == Approx(60).epsilon(0.02));
  CHECK(outcome.out.find("exponent") != std::string::npos);
}

TEST_CASE("psf-bench filter tells wrong use in one line with the right code") {
  CHECK(run("psf-bench filter nowhere.pvb").code == 4);
  CHECK(run("psf-bench filter " PSF_SOURCE_DIR "/README.md").code == 3);
  CHECK(run("psf-bench filter --neighbors 1").code == 2);
  CHECK(run("psf-bench filter --neighbors many").code == 2);
  CHECK(run("psf-bench filter --records 0").code == 2);
  CHECK(run("psf-bench filter --json /nowhere/bench.json").code == 4);
  const Outcome few = run("psf-bench filter --records 100 --neighbors 400 --quiet");
  CHECK(few.code == 3);
  CHECK(few.err.find("--records") != std::string::npos);
}

TEST_CASE("psf-bench filter --check exits with 1 where a target is missed, and names its row") {
  const TempFolder folder;
  const std::string json = folder / "bench.json";
  const Outcome outcome = run(
      "psf-bench filter --records 300 --neighbors 35 --repeat 1 --quiet --check --json " + json);
  bool all_met = true;
  for (const auto& [name, row] : rows_of(Json::parse(read_text(json)))) {
    INFO(name << outcome.err);
    const bool met = row.value("met", true);
    CHECK((outcome.err.find(name) != std::string::npos) == !met);
    all_met = all_met && met;
  }
  CHECK(outcome.code == (all_met ? 0 : 1));
}
