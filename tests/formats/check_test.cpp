// check() names frame, chunk, channel and records of every fault.
#include "formats/check/check.h"

#include <functional>

#include "catch.h"
#include "file_bytes.h"
#include "golden.h"

using namespace psf;
using namespace psf::formats;

namespace {

// The faults of the golden file after a change, by line.
std::vector<std::string> faults(const std::function<void(test::Bytes&)>& change,
                                bool tail = false) {
  const test::Scratch scratch;
  const std::string path = scratch.path("c.pvb");
  if (tail) {
    test::write_golden_tail(path);
  } else {
    test::write_golden(path, Codec::raw);
  }
  test::Bytes bytes = test::load(path);
  change(bytes);
  test::save(path, bytes);
  std::vector<std::string> lines;
  for (const Fault& fault : check(path).faults) lines.push_back(fault.text());
  return lines;
}

void flip(test::Bytes& bytes, std::size_t place) {
  bytes.at(place) ^= std::byte{0x10};
}

}  // namespace

TEST_CASE("a whole file has no fault, and its numbers are told") {
  const test::Scratch scratch;
  test::write_golden(scratch.path("c.pvb"), Codec::zstd);
  const CheckResult report = check(scratch.path("c.pvb"));
  CHECK(report.faults.empty());
  CHECK(report.records == test::kGoldenRecords);
  CHECK(report.passes == 2);
  CHECK(report.chunks == 4);
  CHECK(report.columns == 4 * 19);
  CHECK(report.commits == 3);
  CHECK(report.frames == 9);
  CHECK(report.closed);
  CHECK(faults([](test::Bytes&) {}, true).empty());
}

TEST_CASE("a fault is named by frame, chunk, channel and records") {
  std::size_t chunk = 0;
  const auto column = faults([&](test::Bytes& bytes) {
    chunk = test::frames(bytes, "CHNK").at(1).offset;
    flip(bytes, chunk + test::get(bytes, chunk + 96 + 24 * 4 + 8, 8));
  });
  REQUIRE(column.size() == 1);
  CHECK(column[0] == "byte " + std::to_string(chunk) +
                         ": CHNK 1: channel contribution: records 16-23: its checksum is wrong");

  const auto front = faults([&](test::Bytes& bytes) { flip(bytes, chunk + 70); });
  REQUIRE(front.size() == 1);
  CHECK(test::has(front[0], "CHNK 1: records 16-23: checksum"));

  const auto padding = faults(
      [](test::Bytes& bytes) { flip(bytes, test::frames(bytes, "CHNK").at(2).offset + 4095); });
  REQUIRE(padding.size() == 1);
  CHECK(test::has(padding[0], "CHNK 2: "));
  CHECK(test::has(padding[0], "padding"));

  const auto commit = faults(
      [](test::Bytes& bytes) { flip(bytes, test::frames(bytes, "CMIT").at(1).offset + 70); });
  REQUIRE_FALSE(commit.empty());
  CHECK(test::has(commit[0] + (commit.size() > 1 ? commit[1] : ""), "CMIT"));

  const auto copy = faults([](test::Bytes& bytes) {
    const std::size_t at = test::frames(bytes, "CMIT").at(0).offset;
    flip(bytes, at + test::get(bytes, at + 160, 8) + 200);
  });
  REQUIRE(copy.size() == 1);
  CHECK(test::has(copy[0], "CMIT: the checksum of its copy of HEAD is wrong"));

  const auto slot = faults([](test::Bytes& bytes) { flip(bytes, 4096 + 1024 + 5); });
  REQUIRE(slot.size() == 1);
  CHECK(test::has(slot[0], "SLOT"));
}

TEST_CASE("faults behind the last commit are none; a cut file is one") {
  CHECK(faults([](test::Bytes& bytes) { flip(bytes, bytes.size() - 4000); }, true).empty());
  CHECK(faults([](test::Bytes& bytes) { bytes.resize(bytes.size() - 100); }, true).empty());
  const auto cut = faults([](test::Bytes& bytes) { bytes.resize(bytes.size() - 1); });
  REQUIRE(cut.size() == 1);
  CHECK(test::has(cut[0], "the file was cut"));
}

TEST_CASE("several faults are all named") {
  const auto several = faults([](test::Bytes& bytes) {
    for (const auto& chunk : test::frames(bytes, "CHNK")) {
      flip(bytes, chunk.offset + test::get(bytes, chunk.offset + 96 + 8, 8));
    }
  });
  CHECK(several.size() == 4);
}
