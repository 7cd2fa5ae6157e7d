// What a check says of the indices and chunks of tables: what is wrong, and what is right instead.
#include <algorithm>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "tabled.h"

using namespace psf;
using namespace psf::formats;
using psf::test::has;

namespace {

// A file of four passes with two tables, and what a check finds where it was changed.
class ChangedFile {
 public:
  ChangedFile() {
    test::write_tabled_file(path_, Codec::raw, 4);
    bytes_ = test::load(path_);
  }
  [[nodiscard]] std::vector<test::FramePlace> frames(const std::string& type) const {
    return test::frames(bytes_, type);
  }
  [[nodiscard]] std::uint64_t get(std::size_t place, std::size_t size) const {
    return test::get(bytes_, place, size);
  }
  // Sets a field of a frame, and makes the frame's checksum right again.
  [[nodiscard]] std::vector<Fault> faults_with(const test::FramePlace& frame, std::size_t place,
                                               std::size_t size, std::uint64_t value) const {
    test::Bytes changed = bytes_;
    test::put(changed, place, size, value);
    test::mend(changed, frame.offset);
    test::save(path_, changed);
    return check(path_).faults;
  }

 private:
  test::Scratch scratch_;
  std::string path_ = scratch_.path("tables.pvb");
  test::Bytes bytes_;
};

constexpr std::size_t kDirectory = 64;
// In the directory of a commit of two tables.
constexpr std::size_t kBase = 48, kTotals = 160 + 8, kEntries = kTotals + 2 * 32;
constexpr std::size_t kEntryOffset = 0, kEntryPass = 28;

}  // namespace

TEST_CASE("an index that says another pass than a table's chunk is told with both passes") {
  const ChangedFile file;
  const test::FramePlace last = file.frames("CMIT").back();
  const std::size_t entry = last.offset + kDirectory + kEntries;
  const std::vector<Fault> faults = file.faults_with(last, entry + kEntryPass, 4, 77);
  REQUIRE(faults.size() == 1);
  CHECK(has(faults[0].message, "its index says table marks: records 0-"));
  CHECK(has(faults[0].message, " of pass 77 in "));
  CHECK(has(faults[0].message, " of pass 0 in "));
}

TEST_CASE("a chunk of a table with a pass to come is told, and the chunks behind it are not") {
  const ChangedFile file;
  const std::vector<test::FramePlace> chunks = file.frames("TCHK");
  const std::vector<Fault> faults =
      file.faults_with(chunks[0], chunks[0].offset + kDirectory + 12, 4, 2);
  REQUIRE_FALSE(faults.empty());
  CHECK(std::any_of(faults.begin(), faults.end(), [&](const Fault& fault) {
    return fault.offset == chunks[0].offset &&
           has(fault.message, "of pass 2; expected are records") &&
           has(fault.message, "from 0 on, pass 0");
  }));
  for (const Fault& fault : faults) {
    for (std::size_t k = 1; k < chunks.size(); ++k) CHECK(fault.offset != chunks[k].offset);
  }
}

TEST_CASE("of a chunk that an index puts behind all commits no pass is expected") {
  const ChangedFile file;
  const test::FramePlace last = file.frames("CMIT").back();
  const std::size_t entry = last.offset + kDirectory + kEntries;
  std::size_t told = 0;
  for (const Fault& fault :
       file.faults_with(last, entry + kEntryOffset, 8, std::uint64_t{1} << 60)) {
    if (!has(fault.message, "expected are records from")) continue;
    CHECK_FALSE(has(fault.message, "on, pass"));
    ++told;
  }
  CHECK(told == 1);
}

TEST_CASE("an index of a table that does not begin where its base ends is a fault") {
  const ChangedFile file;
  std::size_t tried = 0;
  for (const test::FramePlace& commit : file.frames("CMIT")) {
    const std::size_t directory = commit.offset + kDirectory, totals = directory + kTotals + 32;
    const std::uint64_t chunks = file.get(totals + 8, 8), first = file.get(totals + 16, 8);
    // Of the last table: its entries are then bytes behind the directory's fields.
    if (chunks == first || file.get(directory + kBase, 8) == 0) continue;
    ++tried;
    const std::vector<Fault> faults = file.faults_with(commit, totals + 16, 8, chunks);
    REQUIRE(faults.size() == 1);
    CHECK(has(faults[0].message, "that its index continues cannot be read or does not fit"));
  }
  CHECK(tried > 0);
}

TEST_CASE("a HEAD that declares more tables than it holds is named") {
  const ChangedFile file;
  const test::FramePlace head = file.frames("HEAD").front();
  const std::size_t directory = head.offset + kDirectory;
  const std::size_t channels = file.get(directory + 16, 4), metadata = file.get(directory + 20, 4);
  std::string text;
  try {
    static_cast<void>(file.faults_with(head, directory + 64 + 64 * channels + metadata, 4, 3));
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::bad_input);
    text = error.what();
  }
  CHECK(has(text, "tables.pvb: HEAD's directory ends early"));
}
