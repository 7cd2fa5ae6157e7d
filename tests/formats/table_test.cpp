// Tables: what is written is read, by pass, and goes on, is joined and is refused as the paths are.
#include <algorithm>
#include <filesystem>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/layout/layout.h"
#include "formats/read/reader.h"
#include "formats/read/statistics.h"
#include "formats/write/concatenate.h"
#include "formats/write/writer.h"
#include "numbered.h"
#include "tabled.h"

using namespace psf;
using namespace psf::formats;

namespace {

bool is_whole(const std::string& path, std::uint64_t passes) {
  const Reader reader(path);
  CHECK(check(path).faults.empty());
  return test::holds_passes(reader, passes) && test::holds_tables(reader, passes);
}

template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// The first `passes` passes, and chunks of the next one behind them.
void write_with_tail(const std::string& path, std::uint64_t passes) {
  Writer writer(path, test::tabled_head(), {Codec::raw, false, {}});
  test::write_tabled(writer, passes);
  test::append_tabled(writer);
}

// The file with the directory of every commit cut where that of version 1.0 ends.
test::Bytes as_copied_by_1_0(const test::Bytes& whole) {
  test::Bytes bytes = whole;
  for (const test::FramePlace& frame : test::frames(whole, "CMIT")) {
    test::put(bytes, frame.offset + 56, 4, kCommitFixed);
    test::mend(bytes, frame.offset);
  }
  return bytes;
}

}  // namespace

TEST_CASE("tables hold what was written, pass by pass, of both codecs") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    test::write_tabled_file(path, codec, 7);
    CHECK(is_whole(path, 7));
    const Reader reader(path);
    CHECK(reader.head().minor == 1);
    CHECK(reader.head().tables == test::tabled_head().tables);
    REQUIRE(reader.find_table("rare") != nullptr);
    CHECK(reader.find_table("rare") == &reader.table(2));
    CHECK(reader.find_table("paths") == &reader.table(0));
    CHECK(reader.find_table("photons") == nullptr);
    CHECK(reader.table(2).passes()[0].count == 0);
    CHECK(reader.table(2).passes()[1].count == 9);
    CHECK(reader.table(2).passes()[2].first == 9);
    const CheckResult report = check(path);
    CHECK(report.table_records == std::vector<std::uint64_t>{reader.table(1).records(), 18});
  }
}

TEST_CASE("any range of a table's records is what the whole has there, as floats too") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  test::write_tabled_file(path, Codec::zstd, 5);
  const Reader reader(path);
  const TableReader& marks = reader.table(1);
  const auto numbers = test::numbers_of(marks);
  for (const auto& [first, count] : {std::pair<std::size_t, std::size_t>{0, 1}, {15, 2}, {3, 90}}) {
    const std::vector<std::uint64_t> part(
        numbers.begin() + static_cast<std::ptrdiff_t>(first),
        numbers.begin() + static_cast<std::ptrdiff_t>(first + count));
    std::vector<float> values(3 * count);
    marks.read_floats(2, first, count, values);
    const auto expected = test::tabled_values(1, 2, part);
    CHECK(std::ranges::equal(std::as_bytes(std::span(values)), expected));
  }
  std::vector<std::byte> out(8);
  const std::string behind = error_of([&] { marks.read(0, marks.records(), 1, out); });
  CHECK(test::has(behind, "table marks"));
  CHECK(test::has(error_of([&] { static_cast<void>(marks.require("power", "x")); }),
                  "table marks: has no channel power"));
  CHECK(channel_sizes(marks)[0].raw == 8 * numbers.size());
  CHECK(channel_statistics(marks, 0)[0].max == 4034);
}

TEST_CASE("a file without tables is one of version 1.0") {
  const test::Scratch scratch;
  const std::string path = scratch.path("n.pvb");
  test::write_numbered_file(path, Codec::raw, 3);
  const test::Bytes bytes = test::load(path);
  CHECK(test::get(bytes, 66, 2) == 0);
  CHECK(test::get(bytes, 72, 4) == 0);
  for (const auto& commit : test::frames(bytes, "CMIT")) {
    CHECK(test::get(bytes, commit.offset + 56, 4) == kCommitFixed);
  }
  CHECK(test::frames(bytes, "TCHK").empty());
}

TEST_CASE("tables of many commits, whose indices build on each other, are opened and continued") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  Writer writer(path, test::tabled_head(), {Codec::raw, false, {}});
  for (const std::uint64_t passes : {1u, 2u, 63u, 64u, 65u, 127u, 129u, 140u}) {
    test::write_tabled(writer, passes);
    CAPTURE(passes);
    CHECK(test::holds_tables(Reader(path), passes));
  }
  writer.close();
  CHECK(is_whole(path, 140));
  Writer again = Writer::resume(path, test::tabled_head(), {Codec::zstd, false, {}});
  test::write_tabled(again, 150);
  CHECK(is_whole(path, 150));
}

TEST_CASE("a commit of the chain that is lost is made up for by the frames of the tables") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  {
    Writer writer(path, test::tabled_head(), {Codec::raw, false, {}});
    test::write_tabled(writer, 9);
  }
  const test::Bytes whole = test::load(path);
  for (const auto& commit : test::frames(whole, "CMIT")) {
    if (commit.offset == test::frames(whole, "CMIT").back().offset) break;
    test::Bytes bytes = whole;
    bytes.at(commit.offset + 70) ^= std::byte{1};
    test::save(path, bytes);
    const Reader reader(path);
    CHECK(test::holds_passes(reader, 9));
    CHECK(test::holds_tables(reader, 9));
  }
}

TEST_CASE("what a table has behind the last commit does not count, and is cut when going on") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  write_with_tail(path, 4);
  CHECK(is_whole(path, 4));
  Writer writer = Writer::resume(path, test::tabled_head(), {Codec::raw, false, {}});
  test::write_tabled(writer, 6);
  writer.close();
  CHECK(is_whole(path, 6));
}

TEST_CASE("a file cut at any page holds the tables of the passes that it has") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  test::write_tabled_file(path, Codec::raw, 5);
  const test::Bytes whole = test::load(path);
  const auto commits = test::frames(whole, "CMIT");
  for (std::size_t size = 8192; size < whole.size(); size += 4096) {
    std::uint64_t passes = 0;
    for (const auto& commit : commits) {
      if (commit.offset + commit.length <= size) {
        passes = test::get(whole, commit.offset + 64 + 32, 8);
      }
    }
    test::save(path, std::span(whole).first(size));
    CAPTURE(size, passes);
    if (passes == 0) {
      CHECK_THROWS_AS(Reader(path), Error);
    } else {
      CHECK(test::holds_tables(Reader(path), passes));
    }
  }
}

TEST_CASE("a reader that refreshes sees the tables of what was committed since") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  Writer writer(path, test::tabled_head(), {Codec::raw, false, {}});
  test::write_tabled(writer, 1);
  Reader reader(path);
  const TableReader& marks = reader.table(1);
  test::write_tabled(writer, 3);
  CHECK(marks.passes().size() == 1);
  CHECK(reader.refresh());
  CHECK(marks.passes().size() == 3);
  CHECK(test::holds_tables(reader, 3));
}

TEST_CASE("only a file with the same tables is continued, and it is told which it has") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  test::write_tabled_file(path, Codec::raw, 2);
  Head other = test::tabled_head();
  other.tables[0].channels[2].components = 2;
  const auto resume = [&](const Head& head) {
    return error_of([&] { static_cast<void>(Writer::resume(path, head)); });
  };
  CHECK(test::has(resume(other),
                  "other tables: as number 1 marks (number u64 x 1, path u32 x 1, "
                  "value f32 x 3, depth u16 x 1), not marks"));
  other.tables.pop_back();
  CHECK(test::has(resume(other), "other tables"));
  CHECK(test::has(resume(test::numbered_head()), "not none"));
  test::write_numbered_file(path, Codec::raw, 2);
  CHECK(test::has(resume(test::tabled_head()), "other tables: as number 1 none, not marks"));
}

TEST_CASE("tables that break the rules are refused before anything is written") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  const auto refusal = [&](const Head& head) {
    return error_of([&] { const Writer writer(path, head); });
  };
  Head head = test::tabled_head();
  head.tables[1].name = "marks";
  CHECK(test::has(refusal(head), "table marks is declared twice"));
  head.tables[1].name = "paths";
  CHECK(test::has(refusal(head), "table paths is declared twice"));
  head.tables[1].name = "";
  CHECK(test::has(refusal(head), "a table's name must be 1 to 56"));
  head.tables[1].name = "rare";
  head.tables[1].channels.clear();
  CHECK(test::has(refusal(head), "table rare: 0 channels"));
  head = test::tabled_head();
  head.tables[0].chunk_capacity = 0;
  CHECK(test::has(refusal(head), "table marks: chunks of 0 records"));
  head = test::tabled_head();
  for (int k = 0; k < 15; ++k) {
    head.tables.push_back(head.tables[0]);
    head.tables.back().name = "more." + std::to_string(k);
  }
  CHECK(test::has(refusal(head), "17 tables; at most 16"));
  CHECK_FALSE(std::filesystem::exists(path));
}

TEST_CASE("a pass needs paths, whatever its tables have") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  Writer writer(path, test::tabled_head(), {Codec::raw, false, {}});
  const std::vector<std::uint64_t> numbers = {1, 2};
  std::vector<std::vector<std::byte>> columns;
  std::vector<const void*> pointers;
  for (std::size_t k = 0; k < 4; ++k) columns.push_back(test::tabled_values(1, k, numbers));
  for (const auto& column : columns) pointers.push_back(column.data());
  writer.append_to(1, 2, pointers);
  CHECK(test::has(error_of([&] { writer.commit(); }), "a pass without records"));
}

TEST_CASE("files with tables are joined, and their passes chosen") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb"), out = scratch.path("out.pvb");
  test::write_tabled_file(path, Codec::raw, 6);
  ConcatenateOptions options;
  options.sync = false;
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    options.codec = codec;
    static_cast<void>(concatenate(std::vector{path}, out, options));
    CHECK(is_whole(out, 6));
    CHECK(Reader(out).table(1).columns(0)[1].codec == codec);
  }
  options.first_pass = 4;
  options.last_pass = 8;
  static_cast<void>(concatenate(std::vector{path, path}, out, options));
  const Reader reader(out);
  CHECK(check(out).faults.empty());
  REQUIRE(reader.table(2).passes().size() == 4);
  CHECK(test::wrong_table_columns(reader) == 0);
  CHECK(reader.table(2).passes()[0].count == 9);  // pass 4
  CHECK(reader.table(2).passes()[1].count == 0);  // 5
  CHECK(reader.table(2).passes()[2].count == 0);  // 0 of the second
  CHECK(reader.table(2).passes()[3].count == 9);  // 1
  CHECK(test::numbers_of(reader.table(2)).front() == 4000);
  CHECK(test::numbers_of(reader.table(2)).back() == 1008);
}

TEST_CASE("a table is dropped by its name, and others are not joined silently") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb"), out = scratch.path("out.pvb");
  const std::string plain = scratch.path("n.pvb");
  test::write_tabled_file(path, Codec::raw, 3);
  test::write_numbered_file(plain, Codec::raw, 3);
  ConcatenateOptions options;
  options.sync = false;
  const std::string other = error_of([&] {
    static_cast<void>(concatenate(std::vector{path, plain}, out, options));
  });
  CHECK(test::has(other, "it has no table marks; 'psf cat --drop' leaves tables out"));
  options.drop = {"marks"};
  static_cast<void>(concatenate(std::vector{path}, out, options));
  CHECK(Reader(out).head().tables.size() == 1);
  CHECK(test::numbers_of(Reader(out).table(1)).size() == 9);
  options.drop = {"marks", "rare", "noise"};
  static_cast<void>(concatenate(std::vector{path}, out, options));
  CHECK(Reader(out).head().minor == 0);
  CHECK(Reader(out).head().table_count() == 1);
  CHECK(check(out).faults.empty());
  options.drop = {"photons"};
  CHECK(
      test::has(error_of([&] { static_cast<void>(concatenate(std::vector{path}, out, options)); }),
                "photons"));
}

TEST_CASE("where a program of version 1.0 has copied the paths, the tables are empty") {
  const test::Scratch scratch;
  const std::string path = scratch.path("t.pvb");
  test::write_tabled_file(path, Codec::raw, 2);
  test::save(path, as_copied_by_1_0(test::load(path)));
  const Reader reader(path);
  CHECK(test::holds_passes(reader, 2));
  CHECK(reader.table(1).records() == 0);
  CHECK(reader.table(1).passes().size() == 2);
  // Here their chunks are still in the file, which check() does not take for granted.
  CHECK_FALSE(check(path).faults.empty());
}
