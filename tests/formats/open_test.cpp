// Opening: a file cut anywhere gives the records of the last commit before the cut; a lost hint
// changes nothing.
#include <unistd.h>

#include <map>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/read/reader.h"
#include "golden.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

// Whether the file holds exactly the first `records` of the golden values.
bool is_prefix(const Reader& reader, std::size_t records) {
  if (reader.records() != records) return false;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    if (test::read_all(reader, k) != test::golden_values(k, 0, records)) return false;
  }
  return true;
}

// Returns the number of cuts.
std::size_t cut_everywhere(const std::string& path, bool with_slot) {
  test::Bytes bytes = test::load(path);
  if (!with_slot) {
    const auto slot = test::frames(bytes, "SLOT").at(0);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(slot.offset), slot.length,
                std::byte{0});
    test::save(path, bytes);
  }
  // Records committed when the file has at least so many bytes.
  std::map<std::size_t, std::size_t> committed = {{0, 0}};
  for (const auto& commit : test::frames(test::load(path + ".whole"), "CMIT")) {
    committed[commit.offset + commit.length] = test::get(bytes, commit.offset + 64 + 16, 8);
  }
  std::size_t wrong = 0, last = 0;
  for (std::size_t size = bytes.size(); size-- > 0;) {
    REQUIRE(::truncate(path.c_str(), static_cast<off_t>(size)) == 0);
    const std::size_t expected = std::prev(committed.upper_bound(size))->second;
    try {
      const Reader reader(path);
      // All values now and then, and whenever the last commit is another.
      const bool all = expected != last || size % 509 == 0;
      const bool right = expected > 0 && reader.records() == expected &&
                         (!all || test::holds_passes(reader, expected / test::kNumberedPass));
      wrong += right ? 0 : 1;
      last = expected;
    } catch (const Error&) {
      wrong += expected == 0 ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
  return bytes.size();
}

}  // namespace

TEST_CASE("a file cut at any byte gives the records of the last commit before") {
  const test::Scratch scratch;
  std::size_t cuts = 0;
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    for (const bool with_slot : {true, false}) {
      const std::string path = scratch.path("cut.pvb");
      test::write_numbered_file(path, codec, 4);
      test::save(path + ".whole", test::load(path));
      const std::size_t bytes = cut_everywhere(path, with_slot);
      CHECK(bytes >= 60'000);
      cuts += bytes;
    }
  }
  CAPTURE(cuts);
  CHECK(cuts > 240'000);
}

TEST_CASE("records behind the last commit are not read") {
  const test::Scratch scratch;
  const std::string path = scratch.path("tail.pvb");
  test::write_golden_tail(path);
  const Reader reader(path);
  CHECK(is_prefix(reader, test::kGoldenRecords));
  CHECK_FALSE(reader.closed());
  CHECK(reader.uncommitted_bytes() == 4096);
  const auto resume = reader.resume_state();
  CHECK(std::string(reinterpret_cast<const char*>(resume.data()), resume.size()) == "resume 1");
}

TEST_CASE("without the hints of the slot page the same commit is found") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.pvb");
  test::write_golden(path, Codec::zstd);
  const test::Bytes whole = test::load(path);
  const auto slot = test::frames(whole, "SLOT").at(0);
  for (const std::size_t place : {std::size_t{0}, std::size_t{1024}, std::size_t{2048}}) {
    test::Bytes bytes = whole;
    bytes.at(slot.offset + place) ^= std::byte{0x55};
    test::save(path, bytes);
    const Reader reader(path);
    CHECK(is_prefix(reader, test::kGoldenRecords));
    CHECK(reader.closed());
  }
  // Hints of commits ago, as after a crash between commit and slot.
  test::Bytes bytes = whole;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(slot.offset + 1024), 32, std::byte{0});
  test::save(path, bytes);
  CHECK(is_prefix(Reader(path), test::kGoldenRecords));
}

TEST_CASE("a damaged commit in the middle costs no record while the chunks tell the same") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.pvb");
  test::write_golden_tail(path);  // not closed: the index of the last commit is not whole
  test::Bytes bytes = test::load(path);
  const auto commits = test::frames(bytes, "CMIT");
  REQUIRE(commits.size() == 2);
  const auto chunks = test::frames(bytes, "CHNK");
  bytes.at(commits[0].offset + 70) ^= std::byte{1};
  test::save(path, bytes);
  CHECK(is_prefix(Reader(path), test::kGoldenRecords));

  // A chunk that only the damaged commit knew: now records are missing, and the error says which.
  bytes.at(chunks[1].offset + 64) ^= std::byte{1};
  test::save(path, bytes);
  try {
    const Reader reader(path);
    FAIL("no error");
  } catch (const Error& error) {
    const std::string text = error.what();
    CHECK(error.code() == ErrorCode::bad_input);
    CHECK(text.find("damaged") != std::string::npos);
    CHECK(text.find("records 16-23") != std::string::npos);
  }
}

TEST_CASE("a last commit that the slot names and that is unreadable is damage, not a tail") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.pvb");
  test::write_golden(path, Codec::raw);
  test::Bytes bytes = test::load(path);
  bytes.at(test::frames(bytes, "CMIT").back().offset + 100) ^= std::byte{1};
  test::save(path, bytes);
  CHECK_THROWS_AS(Reader(path), Error);
}

TEST_CASE("what is no path-vertex buffer is refused in one line") {
  const test::Scratch scratch;
  const auto code_of = [](const std::string& path) {
    try {
      const Reader reader(path);
    } catch (const Error& error) {
      CHECK(std::string(error.what()).find(path) == 0);
      CHECK(std::string(error.what()).find('\n') == std::string::npos);
      return error.code();
    }
    return ErrorCode::comparison;
  };
  CHECK(code_of(scratch.path("missing.pvb")) == ErrorCode::io);
  CHECK(code_of(scratch.path("")) == ErrorCode::io);  // a folder
  CHECK(code_of("/dev/zero") == ErrorCode::io);
  test::save(scratch.path("empty.pvb"), {});
  CHECK(code_of(scratch.path("empty.pvb")) == ErrorCode::bad_input);
  test::save(scratch.path("zeros.pvb"), test::Bytes(100000));
  CHECK(code_of(scratch.path("zeros.pvb")) == ErrorCode::bad_input);
  // A transfer in text mode breaks the magic.
  test::write_golden(scratch.path("text.pvb"), Codec::raw);
  test::Bytes bytes = test::load(scratch.path("text.pvb"));
  bytes.erase(bytes.begin() + 4);  // the 0D of 0D 0A
  test::save(scratch.path("text.pvb"), bytes);
  CHECK(code_of(scratch.path("text.pvb")) == ErrorCode::bad_input);
}
