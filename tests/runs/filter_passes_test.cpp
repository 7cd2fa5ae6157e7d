// Chosen passes and snapshots of a dump are what separate runs give.
#include "catch.h"
#include "core/error.h"
#include "filter_dump_setup.h"
#include "run/filter_dump.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

TEST_CASE("Snapshots are what separate runs over the first passes give") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(1200, 4, 0.2, kTwo);
  tests::write_dump(folder / "a.pvb", set, {kTwo, {200, 200, 200, 200, 200, 200}, {}});
  FilterRequest run = default_run();
  run.snapshots = {1, 2, 4, 6};
  std::vector<std::uint64_t> seen;
  std::vector<std::vector<film::Image>> snapshots;
  run.on_snapshot = [&](std::uint64_t passes, std::span<const run::CameraPictures> pictures) {
    seen.push_back(passes);
    snapshots.push_back(images(pictures));
  };
  const auto final_pictures = filtered(folder / "a.pvb", run);
  REQUIRE(seen == std::vector<std::uint64_t>{1, 2, 4, 6});
  for (std::size_t k = 0; k < seen.size(); ++k) {
    FilterRequest separate = default_run();
    separate.passes.last = seen[k];
    CHECK(same(snapshots[k], filtered(folder / "a.pvb", separate)));
  }
  CHECK(same(snapshots[3], final_pictures));
  CHECK_FALSE(same(snapshots[2], final_pictures));
}

TEST_CASE("A snapshot inside a block holds the passes before it, filtered with the whole block") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(600, 5, 0, kOne);
  tests::write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200}, {}});
  FilterRequest run = default_run("all");
  run.snapshots = {1};
  std::vector<film::Image> snapshot;
  run.on_snapshot = [&](std::uint64_t, std::span<const run::CameraPictures> pictures) {
    snapshot = images(pictures);
  };
  static_cast<void>(filtered(folder / "a.pvb", run));
  Expected expected(kOne);
  const tests::Oracle oracle(set, run.parameters, kOne, 3, 0, 1);
  const tests::OracleResult block = oracle.run(0, 600);
  for (std::size_t i = 0; i < 200; ++i) expected.add(set, i, block, oracle.has_vertex(i));
  CHECK(expected.differences(snapshot) == 0);
}

TEST_CASE("Chosen passes act as a dump of their own") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(600, 6, 0, kOne);
  tests::write_dump(folder / "all.pvb", set, {kOne, {200, 200, 200}, {}});
  RecordSet tail = set;
  const auto cut = [](auto& column) { column.erase(column.begin(), column.begin() + 200); };
  cut(tail.flags), cut(tail.position), cut(tail.distance), cut(tail.throughput),
      cut(tail.contribution);
  cut(tail.unfiltered), cut(tail.pixel), cut(tail.camera), cut(tail.normal), cut(tail.reflectance);
  cut(tail.visibility), cut(tail.hit_distance), cut(tail.direction), cut(tail.material),
      cut(tail.roughness);
  tests::write_dump(folder / "tail.pvb", tail, {kOne, {200, 200}, {}});
  FilterRequest run = default_run();
  const auto expected = filtered(folder / "tail.pvb", run);
  run.passes.first = 1;
  CHECK(same(filtered(folder / "all.pvb", run), expected));
}

TEST_CASE("Passes and snapshots that are not there are refused") {
  const tests::TempFolder folder;
  const RecordSet set = tests::random_records(400, 8, 0, kOne);
  tests::write_dump(folder / "a.pvb", set, {kOne, {200, 200}, {}});
  const auto refused = [&](auto change) {
    FilterRequest run = default_run();
    change(run);
    CHECK_THROWS_AS(filtered(folder / "a.pvb", run), Error);
  };
  refused([](FilterRequest& run) { run.passes = {0, 3}; });
  refused([](FilterRequest& run) { run.passes = {1, 1}; });
  refused([](FilterRequest& run) { run.passes = {2, std::nullopt}; });
  refused([](FilterRequest& run) { run.snapshots = {3}; });
  refused([](FilterRequest& run) { run.snapshots = {0}; });
  refused([](FilterRequest& run) { run.snapshots = {2, 1}; });
  refused([](FilterRequest& run) { run.parameters.radius.delta = 2; });
}

}  // namespace
}  // namespace psf
