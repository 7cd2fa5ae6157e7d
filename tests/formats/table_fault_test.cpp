// Damage of files with tables: one flipped bit, pages zeroed, doubled, swapped or deleted, and fields
// at their extremes never give a wrong value; what is recovered is right, and of a table the passes
// that are whole.
#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "failing.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/check/recover.h"
#include "formats/layout/layout.h"
#include "formats/read/reader.h"
#include "numbered.h"
#include "tabled.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::uint64_t kTabledPasses = 4;

struct DamagedTables {
  bool opened = false;
  std::size_t bad_columns = 0;
  bool named = true;  // every error names its chunk, and its table where it is one's
};

// Reads every column of every chunk. FAILs where a value is wrong, or where records are missing
// though the file is not `shorter`.
DamagedTables read_damaged_tables(const std::string& path, bool shorter = false) {
  DamagedTables outcome;
  try {
    const Reader reader(path);
    outcome.opened = true;
    if (!shorter && reader.passes().size() != kTabledPasses) FAIL("a pass is missing silently");
    for (std::size_t t = 1; t < reader.head().table_count(); ++t) {
      const TableReader& table = reader.table(t);
      for (std::size_t pass = 0; pass < table.passes().size(); ++pass) {
        if (table.passes()[pass].count != test::tabled_count(t, pass)) FAIL("records are missing");
      }
      for (std::size_t chunk = 0; chunk < table.chunks().size(); ++chunk) {
        const ChunkEntry& entry = table.chunks()[chunk];
        std::vector<std::uint64_t> numbers;
        const std::uint64_t from = entry.first - table.passes()[entry.pass].first;
        for (std::uint64_t k = 0; k < entry.count; ++k) {
          numbers.push_back(entry.pass * 1000 + from + k);
        }
        for (std::size_t k = 0; k < table.schema().channels.size(); ++k) {
          test::Bytes out(entry.count * table.schema().channels[k].stride());
          try {
            table.read(k, entry.first, entry.count, out);
            if (out != test::tabled_values(t, k, numbers)) FAIL("a wrong value");
          } catch (const Error& error) {
            const std::string place = "table " + std::string(table.name()) + ": chunk " +
                                      std::to_string(chunk) + " (record";
            outcome.named = outcome.named && test::has(error.what(), place);
            ++outcome.bad_columns;
          }
        }
      }
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::bad_input && error.code() != ErrorCode::limit) throw;
  }
  return outcome;
}

bool finds_damage(const std::string& path) {
  try {
    return !check(path).faults.empty();
  } catch (const Error&) {
    return true;
  }
}

// Bits of all frames, or of those of one type.
std::size_t flip_table_bits(Codec codec, std::size_t step, const std::string& type) {
  const test::Scratch scratch;
  const std::string path = scratch.path("flip.pvb");
  test::write_tabled_file(path, codec, kTabledPasses);
  const test::Bytes bytes = test::load(path);
  const int file = ::open(path.c_str(), O_RDWR);
  std::size_t flips = 0, not_found = 0, not_named = 0, too_many = 0, refused_wrongly = 0;
  for (const test::FramePlace& frame : test::frames(bytes)) {
    if (!type.empty() && frame.type != type) continue;
    for (std::size_t bit = 8 * frame.offset + flips % step; bit < 8 * (frame.offset + frame.length);
         bit += step) {
      const std::size_t place = bit / 8;
      const std::byte flipped = bytes[place] ^ static_cast<std::byte>(1u << bit % 8);
      REQUIRE(::pwrite(file, &flipped, 1, static_cast<off_t>(place)) == 1);
      const DamagedTables outcome = read_damaged_tables(path);
      const std::size_t front = 64 + test::get(bytes, frame.offset + 56, 4);
      const std::size_t most = frame.type != "TCHK"           ? 0
                               : place < frame.offset + front ? 4
                                                              : 1;  // columns of a chunk
      if (!outcome.opened && frame.type == "TCHK") ++refused_wrongly;
      if (outcome.bad_columns > most) ++too_many;
      if (!outcome.named) ++not_named;
      if (!finds_damage(path)) ++not_found;
      REQUIRE(::pwrite(file, &bytes[place], 1, static_cast<off_t>(place)) == 1);
      ++flips;
    }
  }
  ::close(file);
  CAPTURE(flips);
  CHECK(not_found == 0);
  CHECK(not_named == 0);
  CHECK(too_many == 0);
  CHECK(refused_wrongly == 0);
  CHECK_FALSE(finds_damage(path));
  return flips;
}

std::size_t damage_table_pages(Codec codec, std::size_t count) {
  const test::Scratch scratch;
  const std::string path = scratch.path("pages.pvb");
  test::write_tabled_file(path, codec, kTabledPasses);
  const test::Bytes whole = test::load(path);
  std::mt19937 random(6);
  std::size_t cases = 0, not_found = 0;
  while (cases < count) {
    test::Bytes bytes = whole;
    test::damage_page(bytes, random);
    if (bytes == whole) continue;
    ++cases;
    test::save(path, bytes);
    static_cast<void>(read_damaged_tables(path, bytes.size() < whole.size()));
    const bool tail =
        bytes.size() > whole.size() && std::equal(whole.begin(), whole.end(), bytes.begin());
    if (!tail && !finds_damage(path)) ++not_found;
  }
  CHECK(not_found == 0);
  return cases;
}

struct RecoveredTables {
  std::size_t cases = 0, whole = 0, refused = 0, passes_kept = 0, passes_left_out = 0;
};

// Every pass of a table that was saved is whole, and belongs to a pass whose paths are.
void judge_tables(const Reader& reader, RecoveredTables& counts) {
  if (test::wrong_table_columns(reader) > 0) FAIL("a wrong value in a table");
  const std::vector<std::uint64_t> paths = test::numbers_of(reader);
  for (std::size_t pass = 0; pass < reader.passes().size(); ++pass) {
    const Pass& of = reader.passes()[pass];
    const std::uint64_t original = paths[of.first] / test::kNumberedPass;
    for (std::size_t t = 1; t < 3; ++t) {
      const TableReader& table = reader.table(t);
      const Pass& records = table.passes()[pass];
      if (records.count == 0) {
        if (test::tabled_count(t, original) > 0) ++counts.passes_left_out;
        continue;
      }
      ++counts.passes_kept;
      if (records.count != test::tabled_count(t, original)) FAIL("a part of a table's pass");
      if (of.count != test::kNumberedPass) FAIL("a table of a pass of which paths are lost");
      if (test::numbers_of(table)[records.first] != original * 1000) FAIL("of another pass");
    }
  }
}

void recover_damaged(const std::string& in, const std::string& out, RecoveredTables& counts) {
  ++counts.cases;
  std::filesystem::remove(out);
  RecoverResult report;
  try {
    report = recover(in, out);
  } catch (const Error& error) {
    ++counts.refused;
    if (error.code() != ErrorCode::bad_input) FAIL(error.what());
    return;
  }
  const std::vector<Fault> faults = check(out).faults;
  if (!faults.empty()) FAIL("a fault in the output: " << faults[0].text());
  const Reader reader(out);
  if (test::wrong_columns(reader) > 0) FAIL("a wrong value");
  judge_tables(reader, counts);
  if (!report.nothing_lost()) return;
  ++counts.whole;
  if (!test::holds_passes(reader, kTabledPasses) || !test::holds_tables(reader, kTabledPasses)) {
    FAIL("lost records silently");
  }
}

template <class Damage>
RecoveredTables recover_many(std::size_t each, const Damage& damage) {
  const test::WithoutSync fast;
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  RecoveredTables counts;
  std::mt19937 random(22);
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    test::write_tabled_file(in, codec, kTabledPasses);
    const test::Bytes whole = test::load(in);
    for (std::size_t k = 0; k < each; ++k) {
      test::Bytes bytes = whole;
      damage(bytes, random);
      test::save(in, bytes);
      CAPTURE(static_cast<int>(codec), k);
      recover_damaged(in, out, counts);
    }
  }
  CHECK(counts.cases == 2 * each);
  return counts;
}

void flip_and_recover(std::size_t each) {
  const RecoveredTables counts = recover_many(each, [](test::Bytes& bytes, std::mt19937& random) {
    bytes.at(random() % bytes.size()) ^= static_cast<std::byte>(1u << random() % 8);
  });
  CHECK(counts.whole > counts.cases / 4);
  CHECK(counts.passes_left_out > 0);
  CHECK(counts.passes_kept > 10 * counts.passes_left_out);
  CHECK(counts.refused == 0);
}

}  // namespace

TEST_CASE("one flipped bit of a file with tables never gives a wrong value, and check names it") {
  CHECK(flip_table_bits(Codec::raw, 397, "TCHK") + flip_table_bits(Codec::zstd, 397, "TCHK") >
        1500);
  CHECK(flip_table_bits(Codec::raw, 2003, "") > 500);
}

TEST_CASE("every flipped bit of tables and commits never gives a wrong value", "[.][long]") {
  const std::size_t chunks =
      flip_table_bits(Codec::raw, 1, "TCHK") + flip_table_bits(Codec::zstd, 1, "TCHK");
  CHECK(chunks + flip_table_bits(Codec::raw, 1, "CMIT") >= 1'000'000);
}

TEST_CASE("damaged pages of a file with tables never give a wrong value") {
  CHECK(damage_table_pages(Codec::raw, 300) + damage_table_pages(Codec::zstd, 300) == 600);
}

TEST_CASE("many damaged pages of a file with tables never give a wrong value", "[.][long]") {
  CHECK(damage_table_pages(Codec::raw, 20'000) + damage_table_pages(Codec::zstd, 20'000) == 40'000);
}

TEST_CASE("of a file with tables the passes that are whole are recovered") {
  flip_and_recover(150);
  const RecoveredTables pages = recover_many(150, test::damage_page);
  CHECK(pages.passes_kept > pages.passes_left_out);
  CHECK(pages.passes_left_out > 0);
}

TEST_CASE("of many damaged files with tables the passes that are whole are recovered",
          "[.][long]") {
  flip_and_recover(5'000);
  CHECK(recover_many(5'000, test::damage_page).passes_left_out > 0);
}

TEST_CASE(
    "a lost chunk of a table is told with its table, and costs the pass of that table alone") {
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  test::write_tabled_file(in, Codec::raw, kTabledPasses);
  test::Bytes bytes = test::load(in);
  const auto chunk = test::frames(bytes, "TCHK").at(0);
  bytes.at(chunk.offset + 256) ^= std::byte{1};
  test::save(in, bytes);
  const std::vector<Fault> faults = check(in).faults;
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].table == "marks");
  CHECK(test::has(faults[0].text(), ": TCHK 0: table marks: channel "));
  const RecoverResult report = recover(in, out);
  REQUIRE(report.losses.size() == 1);
  CHECK(report.losses[0].table == "marks");
  CHECK(report.losses[0].records == test::tabled_count(1, 0));
  CHECK(report.records_lost == 0);
  const Reader reader(out);
  CHECK(test::holds_passes(reader, kTabledPasses));
  CHECK(reader.table(1).passes()[0].count == 0);
  CHECK(reader.table(1).passes()[1].count == test::tabled_count(1, 1));
  CHECK(reader.table(2).records() == 9);
}

TEST_CASE("a lost chunk of the paths costs the tables' records of its pass") {
  const test::Scratch scratch;
  const std::string in = scratch.path("in.pvb"), out = scratch.path("out.pvb");
  test::write_tabled_file(in, Codec::raw, kTabledPasses);
  test::Bytes bytes = test::load(in);
  const auto chunk = test::frames(bytes, "CHNK").at(4);  // of pass 1
  bytes.at(chunk.offset + 500) ^= std::byte{1};
  test::save(in, bytes);
  const RecoverResult report = recover(in, out);
  CHECK(report.losses.size() == 3);
  const Reader reader(out);
  CHECK(reader.table(1).passes()[0].count == test::tabled_count(1, 0));
  CHECK(reader.table(1).passes()[1].count == 0);
  CHECK(reader.table(2).records() == 0);
  CHECK(reader.table(1).passes()[2].count == test::tabled_count(1, 2));
}

TEST_CASE("fields of tables at their extremes are refused, or change nothing") {
  const test::Scratch scratch;
  const std::string path = scratch.path("field.pvb");
  test::write_tabled_file(path, Codec::raw, 2);
  const test::Bytes whole = test::load(path);
  struct Place {
    std::size_t frame, offset, size;
  };
  std::vector<Place> places;
  const test::FramePlace head = test::frames(whole, "HEAD").at(0);
  const std::size_t tables = 128 + 64 * 10 + test::get(whole, 84, 4);  // behind the metadata
  for (const std::size_t offset : {0u, 8u, 64u, 68u, 72u, 128u, 129u, 130u}) {
    places.push_back({head.offset, tables + offset, 4});
  }
  const test::FramePlace chunk = test::frames(whole, "TCHK").at(0);
  for (const std::size_t offset : {64u, 72u, 76u, 80u, 84u, 96u, 98u, 104u, 112u}) {
    places.push_back({chunk.offset, offset, offset == 64 || offset >= 104 ? 8u : 4u});
  }
  const test::FramePlace commit = test::frames(whole, "CMIT").back();
  for (std::size_t offset = 64 + 160; offset < 64 + test::get(whole, commit.offset + 56, 4);
       offset += 8) {
    places.push_back({commit.offset, offset, 8});
  }
  for (const Place& place : places) {
    for (const std::uint64_t value :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{17}, std::uint64_t{1} << 31,
          std::uint64_t{0xFFFFFFFF}, std::uint64_t{1} << 32, std::uint64_t{1} << 63,
          ~std::uint64_t{0}}) {
      test::Bytes bytes = whole;
      test::put(bytes, place.frame + place.offset, place.size, value);
      if (bytes == whole) continue;
      test::mend(bytes, place.frame);
      test::save(path, bytes);
      CAPTURE(place.frame, place.offset, value);
      try {
        const Reader reader(path);
        for (std::size_t t = 1; t < reader.head().table_count(); ++t) {
          if (reader.table(t).records() > 100) FAIL("more records than there are");
          static_cast<void>(test::numbers_of(reader.table(t)));
        }
      } catch (const Error&) {
      }
      CHECK_NOTHROW(finds_damage(path));
    }
  }
}
