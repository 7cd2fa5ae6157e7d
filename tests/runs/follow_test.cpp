// Following a dump that grows gives, after every commit, what filtering it would give then.
#include <filesystem>

#include "catch.h"
#include "core/error.h"
#include "filter_dump_setup.h"
#include "run/filter_dump.h"

namespace psf {
namespace {

using namespace tests;  // NOLINT: the set-up that these tests share

// Versions of a dump of passes of 200 records: one a number of passes, then the closed one.
class GrowingDump {
 public:
  GrowingDump(std::string path, const RecordSet& set, const std::vector<std::size_t>& counts)
      : path_(std::move(path)) {
    write_dump(path_ + ".whole", set, {kOne, std::vector<std::size_t>(counts.back(), 200), {}});
    const formats::Reader whole(path_ + ".whole");
    // Where each commit ends, the next pass begins or the closing commit stands.
    for (const std::size_t count : counts) {
      const auto& chunks = whole.chunks();
      std::uint64_t end = whole.file_bytes() - 4096;
      for (const auto& chunk : chunks) {
        if (chunk.pass == count) {
          end = chunk.offset;
          break;
        }
      }
      ends_.push_back(end);
    }
    ends_.push_back(whole.file_bytes());
    grow();
  }
  // False where there is no more. Each version is written over the last: the same bytes and more.
  bool grow() {
    if (next_ == ends_.size()) return false;
    const std::string bytes = read_bytes().substr(0, ends_[next_++]);
    std::FILE* file = std::fopen(path_.c_str(), next_ == 1 ? "wb" : "r+b");
    std::fwrite(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
    return true;
  }

 private:
  [[nodiscard]] std::string read_bytes() const {
    std::string bytes(std::filesystem::file_size(path_ + ".whole"), '\0');
    std::FILE* file = std::fopen((path_ + ".whole").c_str(), "rb");
    const std::size_t got = std::fread(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
    REQUIRE(got == bytes.size());
    return bytes;
  }
  std::string path_;
  std::vector<std::uint64_t> ends_;
  std::size_t next_ = 0;
};

TEST_CASE("Following gives what filtering gives after every commit, for blocks of every kind") {
  const RecordSet set = random_records(1400, 11, 0.1, kOne);
  for (const char* block : {"1pass", "2passes", "3passes", "2^8", "2^6", "2^12", "all"}) {
    CAPTURE(block);
    const TempFolder folder;
    const std::string path = folder / "a.pvb";
    GrowingDump growing(path, set, {1, 2, 3, 5, 6, 7});
    run::Dump dump(path);
    const FilterRequest run = default_run(block);
    std::vector<std::uint64_t> seen;
    const auto on_pictures = [&](const run::FilterResult& now) {
      seen.push_back(now.passes);
      FilterRequest separate = run;
      separate.passes.last = now.passes;
      const run::FilterResult expected = run::filter_dump(run::Dump(path + ".whole"), separate);
      CHECK(same(images(now.pictures), images(expected.pictures)));
      CHECK(now.blocks == expected.blocks);
      CHECK(now.statistics.queries == expected.statistics.queries);
      CHECK(now.statistics.accepted == expected.statistics.accepted);
    };
    const auto outcome = run::follow_dump(dump, run, on_pictures, [&] { REQUIRE(growing.grow()); });
    CHECK(seen == std::vector<std::uint64_t>{1, 2, 3, 5, 6, 7});
    CHECK(outcome.passes == 7);
  }
}

TEST_CASE("Following a selection waits for its first pass and ends with its last") {
  const RecordSet set = random_records(1400, 12, 0, kOne);
  const TempFolder folder;
  const std::string path = folder / "a.pvb";
  GrowingDump growing(path, set, {1, 2, 3, 4, 5, 6, 7});
  run::Dump dump(path);
  FilterRequest run = default_run("2passes");
  run.passes = {2, 5};
  std::vector<std::uint64_t> seen;
  const auto outcome = run::follow_dump(
      dump, run, [&](const run::FilterResult& now) { seen.push_back(now.passes); },
      [&] { REQUIRE(growing.grow()); });
  CHECK(seen == std::vector<std::uint64_t>{1, 2, 3});
  CHECK(same(images(outcome.pictures), filtered(path + ".whole", run)));
}

TEST_CASE("Following a closed dump without the passes asked for is an error") {
  const RecordSet set = random_records(400, 13, 0, kOne);
  const TempFolder folder;
  write_dump(folder / "a.pvb", set, {kOne, {200, 200}, {}});
  run::Dump dump(folder / "a.pvb");
  FilterRequest run = default_run();
  run.passes = {2, 5};
  CHECK_THROWS_AS(run::follow_dump(
                      dump, run, [](const run::FilterResult&) { FAIL("a picture"); },
                      [] { FAIL("waits for what never comes"); }),
                  Error);
}

}  // namespace
}  // namespace psf
