// recover() on thousands of damaged files: what it writes opens, has no fault and no wrong value,
// has every chunk that was not touched, and where it says that nothing is lost, nothing is.
#include <filesystem>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/recover.h"
#include "numbered.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::uint64_t kDamagedPasses = 4;
constexpr std::uint64_t kDamagedRecords = kDamagedPasses * test::kNumberedPass;

// Closed; not closed; not closed and with chunks behind the last commit.
enum class Kind { closed, open, tail };
constexpr Kind kKinds[] = {Kind::closed, Kind::open, Kind::tail};

test::Bytes make(const std::string& path, Codec codec, Kind kind) {
  Writer writer(path, test::numbered_head(), {codec, false, {}});
  test::write_numbered(writer, kDamagedPasses);
  if (kind == Kind::closed) writer.close();
  if (kind == Kind::tail) {
    test::append_numbered(writer, kDamagedRecords, 2 * test::kNumberedCapacity);
  }
  return test::load(path);
}

struct Counts {
  std::size_t cases = 0, whole = 0, losses = 0, refused = 0;
};

class Judge {
 public:
  Judge(Codec codec, Kind kind) : whole_(make(in_, codec, kind)) {
    for (const auto& chunk : test::frames(whole_, "CHNK")) {
      if (test::get(whole_, chunk.offset + 64, 8) < kDamagedRecords) chunks_.push_back(chunk);
    }
  }

  [[nodiscard]] const test::Bytes& whole() const { return whole_; }

  // FAILs where recover() breaks what it promises. `least`: records that must be saved.
  void judge(std::span<const std::byte> bytes, std::uint64_t least, Counts& counts) {
    ++counts.cases;
    test::save(in_, bytes);
    std::filesystem::remove(out_);
    RecoverResult report;
    try {
      report = recover(in_, out_);
    } catch (const Error& error) {
      ++counts.refused;
      if (error.code() != ErrorCode::bad_input) FAIL(error.what());
      if (least > 0) FAIL("saved nothing: " << error.what());
      if (std::filesystem::exists(out_)) FAIL("wrote something and failed: " << error.what());
      return;
    }
    ++(report.nothing_lost() ? counts.whole : counts.losses);
    const std::vector<Fault> faults = check(out_).faults;
    if (!faults.empty()) FAIL("a fault in the output: " << faults[0].text());
    const Reader reader(out_);
    const std::vector<std::uint64_t> numbers = test::numbers_of(reader);
    if (numbers.size() != report.records_saved) FAIL("the report counts otherwise");
    if (!reader.closed()) FAIL("not closed");
    if (test::wrong_columns(reader) > 0) FAIL("a wrong value");
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      if (numbers[k] >= kDamagedRecords) FAIL("a record that was never committed");
      if (k > 0 && numbers[k] <= numbers[k - 1]) FAIL("a record twice or out of order");
    }
    if (report.nothing_lost() && numbers.size() != kDamagedRecords) FAIL("lost records silently");
    if (numbers.size() < least) FAIL("saved " << numbers.size() << " of at least " << least);
    if (std::filesystem::exists(out_ + ".partial")) FAIL("left a temporary file");
  }

  // Records of committed chunks that stand where they stood, byte for byte. Without the slot a last
  // commit that is lost too leaves no trace: then not those of the last pass.
  [[nodiscard]] std::uint64_t untouched(const test::Bytes& bytes) const {
    const bool slot = bytes.size() >= 8192 &&
                      std::equal(bytes.begin() + 4096, bytes.begin() + 8192, whole_.begin() + 4096);
    const std::uint64_t proven = slot ? kDamagedRecords : kDamagedRecords - test::kNumberedPass;
    std::uint64_t records = 0;
    for (const test::FramePlace& chunk : chunks_) {
      if (test::get(whole_, chunk.offset + 64, 8) >= proven) continue;
      const auto begin = static_cast<std::ptrdiff_t>(chunk.offset);
      const auto end = begin + static_cast<std::ptrdiff_t>(chunk.length);
      if (end <= static_cast<std::ptrdiff_t>(bytes.size()) &&
          std::equal(bytes.begin() + begin, bytes.begin() + end, whole_.begin() + begin)) {
        records += test::get(whole_, chunk.offset + 72, 4);
      }
    }
    return records;
  }

 private:
  const test::WithoutSync fast_;
  const test::Scratch scratch_;
  const std::string in_ = scratch_.path("in.pvb"), out_ = scratch_.path("out.pvb");
  const test::Bytes whole_;
  std::vector<test::FramePlace> chunks_;  // committed
};

// Each on all kinds of file; `damage` changes the bytes, and may hit HEAD with all its copies where
// `all_heads`.
template <class Damage>
Counts damage_files(std::size_t each, bool all_heads, const Damage& damage) {
  Counts counts;
  std::mt19937 random(21);
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    for (const Kind kind : kKinds) {
      Judge judge(codec, kind);
      for (std::size_t k = 0; k < each; ++k) {
        test::Bytes bytes = judge.whole();
        damage(bytes, random);
        CAPTURE(static_cast<int>(codec), static_cast<int>(kind), k);
        const bool hopeless =
            all_heads && !std::equal(bytes.begin(), bytes.begin() + 4096, judge.whole().begin());
        judge.judge(bytes, hopeless ? 0 : judge.untouched(bytes), counts);
      }
    }
  }
  CAPTURE(counts.cases, counts.whole, counts.losses, counts.refused);
  CHECK(counts.cases == 6 * each);
  return counts;
}

void flip_bits(std::size_t each) {
  const Counts counts = damage_files(each, false, [](test::Bytes& bytes, std::mt19937& random) {
    bytes.at(random() % bytes.size()) ^= static_cast<std::byte>(1u << random() % 8);
  });
  CHECK(counts.whole > counts.cases / 4);  // much is padding
  CHECK(counts.losses > 0);
  CHECK(counts.refused == 0);
}

void flip_many_bytes(std::size_t each) {
  const Counts counts = damage_files(each, true, [](test::Bytes& bytes, std::mt19937& random) {
    for (std::size_t k = 0; k < 20; ++k) {
      bytes.at(random() % bytes.size()) = static_cast<std::byte>(random());
    }
  });
  CHECK(counts.losses > counts.cases / 4);
}

void shuffle_pages(std::size_t each) {
  const Counts counts = damage_files(each, false, test::damage_page);
  CHECK(counts.whole > 0);
  CHECK(counts.losses > 0);
  CHECK(counts.refused > 0);  // all moved by a page
}

void cut(Codec codec, Kind kind, std::size_t step) {
  Judge judge(codec, kind);
  Counts counts;
  const auto commits = test::frames(judge.whole(), "CMIT");
  for (std::size_t size = 0; size < judge.whole().size(); size += step) {
    std::uint64_t committed = 0;
    for (const auto& commit : commits) {
      if (commit.offset + commit.length > size) break;
      committed = test::get(judge.whole(), commit.offset + 64 + 16, 8);
    }
    CAPTURE(size);
    judge.judge(std::span(judge.whole()).first(size), committed, counts);
  }
  CAPTURE(counts.cases, counts.whole, counts.losses, counts.refused);
  CHECK(judge.whole().size() >= 60'000);
  CHECK(counts.cases == (judge.whole().size() + step - 1) / step);
  CHECK(counts.losses > 0);
  CHECK(counts.refused > 0);
}

}  // namespace

TEST_CASE("recovery of files with flipped bits or wrong bytes keeps its promises") {
  flip_bits(80);
  flip_many_bytes(40);
}

TEST_CASE("recovery of many files with flipped bits or wrong bytes keeps its promises",
          "[.][long]") {
  flip_bits(6000);
  flip_many_bytes(2000);
}

TEST_CASE("recovery of files with misplaced pages keeps its promises") {
  shuffle_pages(100);
}

TEST_CASE("recovery of many files with misplaced pages keeps its promises", "[.][long]") {
  shuffle_pages(6000);
}

TEST_CASE("recovery of a file that was cut gives the records of the last commit at least") {
  cut(Codec::raw, Kind::closed, 499);
  cut(Codec::zstd, Kind::open, 997);
}

TEST_CASE("recovery of a file that was cut at every byte gives the records of the last commit",
          "[.][long]") {
  cut(Codec::raw, Kind::closed, 1);
  cut(Codec::zstd, Kind::tail, 7);
}
