// recover() saves what is whole, names what is lost, and knows which of both it is.
#include "formats/check/recover.h"

#include <filesystem>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/read/reader.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::uint64_t kPasses = 4;
constexpr std::uint64_t kRecords = kPasses * test::kNumberedPass;

// A file in a folder, its damage and what came of it.
struct Case {
  explicit Case(Codec codec, bool closed = true) {
    Writer writer(in, test::numbered_head(), {codec, false, {}});
    test::write_numbered(writer, kPasses);
    if (closed) writer.close();
    whole = bytes = test::load(in);
  }

  RecoverResult run(const RecoverOptions& options = {}) {
    test::save(in, bytes);
    std::filesystem::remove(out);
    const RecoverResult report = recover(in, out, options);
    CHECK(check(out).faults.empty());
    CHECK_FALSE(std::filesystem::exists(out + ".partial"));
    bytes = whole;
    return report;
  }
  void flip(std::size_t place) { bytes.at(place) ^= std::byte{0x20}; }

  const test::WithoutSync fast;
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  test::Bytes whole, bytes;
};

// All that was there, the resume state too.
void check_whole(const Case& c, const RecoverResult& report) {
  CHECK(report.nothing_lost());
  CHECK(report.records_saved == kRecords);
  CHECK(report.records_lost == 0);
  CHECK(report.passes_saved == kPasses);
  CHECK(report.chunks_saved == 3 * kPasses);
  const Reader reader(c.out);
  CHECK(test::holds_passes(reader, kPasses));
  CHECK(reader.closed());
}

std::vector<std::uint64_t> all_but(std::uint64_t first, std::uint64_t count) {
  std::vector<std::uint64_t> numbers = test::numbers_from(0, kRecords);
  const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(first);
  numbers.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
  return numbers;
}

std::string state_of(const std::string& path) {
  const auto state = Reader(path).resume_state();
  return {reinterpret_cast<const char*>(state.data()), state.size()};
}

}  // namespace

TEST_CASE("a file without a fault is recovered whole, under another uuid") {
  Case c(Codec::zstd);
  const RecoverResult report = c.run();
  check_whole(c, report);
  CHECK(report.faults.empty());
  CHECK_FALSE(report.head_restored);
  CHECK(Reader(c.out).uuid() != Reader(c.in).uuid());
  CHECK(state_of(c.out) == test::numbered_state(kPasses));
  // As stored, so no larger.
  CHECK(std::filesystem::file_size(c.out) < c.whole.size() + 2 * 4096);
}

namespace {

void destroy_head(std::size_t step) {
  Case c(Codec::raw);
  const std::size_t front = 64 + test::get(c.whole, 56, 4);
  std::size_t cases = 0;
  for (std::size_t place = 0; place <= front;
       place += place < front ? std::min(step, front - place) : 1) {
    CAPTURE(place);
    if (place < front) {
      c.bytes.at(place) ^= static_cast<std::byte>(1u << place % 8);
    } else {
      std::fill_n(c.bytes.begin(), 4096, std::byte{0});
    }
    test::save(c.in, c.bytes);
    CHECK_THROWS_AS(Reader(c.in), Error);
    const RecoverResult report = c.run();
    check_whole(c, report);
    CHECK(report.head_restored);
    REQUIRE(report.faults.size() == 1);
    CHECK(report.faults[0].frame == "HEAD");
    const Head head = Reader(c.out).head();
    CHECK(head.channels == test::numbered_head().channels);
    CHECK(head.metadata == test::numbered_head().metadata);
    CHECK(head.chunk_capacity == test::kNumberedCapacity);
    CHECK(state_of(c.out) == test::numbered_state(kPasses));
    ++cases;
    if (place % 100 != 0) continue;
    Writer writer = Writer::resume(c.out, test::numbered_head(), {Codec::raw, false, {}});
    test::write_numbered(writer, kPasses + 1);
    CHECK(test::holds_passes(Reader(c.out), kPasses + 1));
  }
  CAPTURE(cases);
  CHECK(cases == (front + step - 1) / step + 1);
  CHECK(cases > 500 / step);
}

}  // namespace

TEST_CASE("HEAD destroyed at some byte is refused, and recovered from a commit's copy") {
  destroy_head(5);
}

TEST_CASE("HEAD destroyed at each byte is refused, and recovered from a commit's copy",
          "[.][long]") {
  destroy_head(1);
}

TEST_CASE("HEAD is restored while one commit has a whole copy of it") {
  Case c(Codec::zstd);
  const auto commits = test::frames(c.whole, "CMIT");
  for (std::size_t damaged = 0; damaged <= commits.size(); ++damaged) {
    CAPTURE(damaged);
    c.flip(200);
    for (std::size_t k = 0; k < damaged; ++k) {
      c.flip(commits[k].offset + test::get(c.whole, commits[k].offset + 160, 8) + 300);
    }
    if (damaged < commits.size()) {
      const RecoverResult report = c.run();
      check_whole(c, report);
      CHECK(report.head_restored);
    } else {
      CHECK_THROWS_AS(c.run(), Error);
      CHECK_FALSE(std::filesystem::exists(c.out));
    }
    c.bytes = c.whole;
  }
}

TEST_CASE("a damaged column costs its chunk and nothing else") {
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    Case c(codec);
    const auto chunks = test::frames(c.whole, "CHNK");
    for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
      const std::size_t frame = chunks[chunk].offset;
      for (std::size_t k = 0; k < test::numbered_head().channels.size(); ++k) {
        CAPTURE(chunk, k);
        const std::size_t column = frame + 96 + 24 * k;
        c.flip(frame + test::get(c.whole, column + 8, 8) + test::get(c.whole, column + 16, 8) / 2);
        const RecoverResult report = c.run();
        const std::uint64_t first = test::get(c.whole, frame + 64, 8);
        const std::uint64_t count = test::get(c.whole, frame + 72, 4);
        CHECK_FALSE(report.nothing_lost());
        REQUIRE(report.losses.size() == 1);
        CHECK(report.losses[0].chunk == chunk);
        CHECK(report.losses[0].channel == test::numbered_head().channels[k].name);
        CHECK(report.losses[0].first == first);
        CHECK(report.losses[0].records == count);
        CHECK(report.faults.size() == 1);
        CHECK(report.records_lost == count);
        CHECK(report.records_saved == kRecords - count);
        const Reader reader(c.out);
        CHECK(test::numbers_of(reader) == all_but(first, count));
        CHECK(test::wrong_columns(reader) == 0);
        CHECK(state_of(c.out).empty());  // its producer would go on in the wrong place
      }
    }
  }
}

TEST_CASE("the damaged front of a chunk costs that chunk, which the index still names") {
  Case c(Codec::raw);
  const auto chunks = test::frames(c.whole, "CHNK");
  for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
    CAPTURE(chunk);
    c.flip(chunks[chunk].offset + 70);
    const RecoverResult report = c.run();
    const std::uint64_t first = test::get(c.whole, chunks[chunk].offset + 64, 8);
    const std::uint64_t count = test::get(c.whole, chunks[chunk].offset + 72, 4);
    REQUIRE(report.losses.size() == 1);
    CHECK(report.losses[0].chunk == chunk);
    CHECK(report.losses[0].first == first);
    CHECK(report.losses[0].records == count);
    CHECK(test::numbers_of(Reader(c.out)) == all_but(first, count));
  }
}

TEST_CASE("damaged commits, indices, copies and slots cost no record") {
  for (const bool closed : {true, false}) {
    Case c(Codec::zstd, closed);
    std::vector<std::size_t> places = {4096 + 5, 4096 + 1024 + 3, 4096 + 2048 + 9, 4096 + 3000};
    for (const auto& commit : test::frames(c.whole, "CMIT")) {
      for (const std::size_t in_frame : {std::size_t{9}, std::size_t{100}}) {
        places.push_back(commit.offset + in_frame);
      }
      for (const std::size_t section : {136u, 160u}) {
        places.push_back(commit.offset + test::get(c.whole, commit.offset + section, 8) + 5);
      }
    }
    for (const std::size_t place : places) {
      CAPTURE(closed, place);
      c.flip(place);
      const RecoverResult report = c.run();
      check_whole(c, report);
      CHECK_FALSE(report.faults.empty());
    }
  }
}

TEST_CASE("records of a pass that no commit ends are left, or saved where asked") {
  Case c(Codec::raw, false);
  {
    Writer writer = Writer::resume(c.in, test::numbered_head(), {Codec::raw, false, {}});
    test::append_numbered(writer, kRecords, 2 * test::kNumberedCapacity);
    c.whole = c.bytes = test::load(c.in);
  }
  const RecoverResult left = c.run();
  check_whole(c, left);
  CHECK(left.uncommitted_bytes == 2 * 4096);
  CHECK(state_of(c.out) == test::numbered_state(kPasses));

  const RecoverResult taken = c.run({true});
  CHECK(taken.nothing_lost());
  CHECK(taken.uncommitted_bytes == 0);
  CHECK(taken.records_saved == kRecords + 2 * test::kNumberedCapacity);
  CHECK(taken.passes_saved == kPasses + 1);
  const Reader reader(c.out);
  CHECK(test::numbers_of(reader) == test::numbers_from(0, taken.records_saved));
  CHECK(test::wrong_columns(reader) == 0);
  CHECK(state_of(c.out).empty());
}

TEST_CASE("a file whose only pass was never committed gives its records where asked") {
  Case c(Codec::raw);
  const std::size_t first = test::frames(c.whole, "CMIT").at(0).offset;
  c.bytes.resize(first);
  std::fill_n(c.bytes.begin() + 4096 + 1024, 3072, std::byte{0});  // never written
  const test::Bytes cut = c.bytes;
  CHECK_THROWS_AS(c.run(), Error);
  c.bytes = cut;
  const RecoverResult report = c.run({true});
  CHECK(report.nothing_lost());
  CHECK(test::holds_passes(Reader(c.out), 1));
}

TEST_CASE("where slot and last commit are both lost, nobody says that nothing is") {
  Case c(Codec::raw, false);
  c.flip(4096 + 5);
  c.flip(test::frames(c.whole, "CMIT").back().offset + 70);
  const RecoverResult report = c.run();
  CHECK_FALSE(report.nothing_lost());
  CHECK(report.losses.back().frame == "SLOT");
  CHECK(report.records_saved == kRecords - test::kNumberedPass);
  CHECK(test::holds_passes(Reader(c.out), kPasses - 1));
}
