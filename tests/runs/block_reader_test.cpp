// Blocks come in the order asked for, read ahead or not, and so do their errors.
#include "run/block_reader.h"

#include "catch.h"
#include "core/error.h"
#include "filter_dump_setup.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

bool equal(const run::BlockRecords& a, const run::BlockRecords& b) {
  return a.flags == b.flags && a.position == b.position && a.distance == b.distance &&
         a.throughput == b.throughput && a.contribution == b.contribution &&
         a.unfiltered == b.unfiltered && a.pixel == b.pixel && a.camera == b.camera &&
         a.normal == b.normal && a.reflectance == b.reflectance && a.visibility == b.visibility;
}

TEST_CASE("Blocks read ahead, or not, or other ones than announced, are what the dump holds") {
  const TempFolder folder;
  const RecordSet set = random_records(2000, 21, 0.2, kTwo);
  write_dump(folder / "a.pvb", set, {kTwo, {1000, 1000}, {}});
  const run::Dump dump(folder / "a.pvb");
  const run::ChannelSet channels = dump.select({}, true);
  const std::vector<filter::PathRange> ranges = {
      {0, 300}, {300, 600}, {600, 1900}, {1900, 1901}, {1901, 2000}};
  run::BlockRecords expected;
  for (const std::size_t announced_ahead : {0u, 1u, 2u}) {  // 0: none; 2: not the one that comes
    run::BlockReader reader(dump, channels);
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      const std::size_t next = k + announced_ahead;
      const bool ahead = announced_ahead > 0 && next < ranges.size();
      const run::BlockRecords& got =
          reader.read(ranges[k], ahead ? std::optional(ranges[next]) : std::nullopt);
      dump.read(ranges[k], channels, expected);
      CHECK(equal(got, expected));
    }
    CHECK(reader.seconds() > 0);
  }
}

TEST_CASE("A block that cannot be read is an error when its turn comes, after what came before") {
  const TempFolder folder;
  RecordSet set = random_records(800, 22, 0, kOne);
  set.pixel[450] = 200;  // in the third pass
  write_dump(folder / "a.pvb", set, {kOne, {200, 200, 200, 200}, {}});
  const std::string expected = folder / "a.pvb" + ": record 450: pixel 200 is outside";
  for (const std::size_t threads : {1u, 4u}) {
    const core::ThreadLimit limit(threads);
    FilterRequest run = default_run();
    run.snapshots = {1, 2, 3};
    std::vector<std::uint64_t> seen;
    run.on_snapshot = [&](std::uint64_t passes, std::span<const run::CameraPictures>) {
      seen.push_back(passes);
    };
    try {
      static_cast<void>(filtered(folder / "a.pvb", run));
      FAIL("no error");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::bad_input);
      CHECK(std::string(error.what()).starts_with(expected));
    }
    CHECK(seen == std::vector<std::uint64_t>{1, 2});
  }
}

}  // namespace
}  // namespace psf
