// Damaged files with tables, through the C header: never a wrong value, and a named table, chunk and
// channel.
#include <random>

#include "catch.h"
#include "golden.h"
#include "table_file.h"

using namespace psf;
using test::Bytes;
using test::CFile;

namespace {

constexpr std::size_t kPasses = 6;

struct Chunk {
  std::size_t table, number, first, count;
};

// Those of both tables.
std::vector<Chunk> chunks_of_tables() {
  std::vector<Chunk> out;
  std::size_t next[2] = {0, 0}, number[2] = {0, 0};
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    for (std::size_t t = 0; t < 2; ++t) {
      const std::size_t end = next[t] + test::table_records(t, pass);
      while (next[t] < end) {
        const std::size_t capacity = test::golden_tables()[t].capacity;
        const std::size_t count = std::min(capacity, end - next[t]);
        out.push_back({t, number[t]++, next[t], count});
        next[t] += count;
      }
    }
  }
  return out;
}

// The one whose frame stands at `offset`.
Chunk chunk_at(const Bytes& bytes, std::size_t offset) {
  for (const Chunk& chunk : chunks_of_tables()) {
    if (test::get(bytes, offset + 84, 4) != chunk.table + 1) continue;
    if (test::get(bytes, offset + 64, 8) == chunk.first) return chunk;
  }
  FAIL("no chunk of a table at " << offset);
  return {};
}

struct TableTally {
  std::size_t refused = 0, unreadable = 0, wrong = 0, unnamed = 0;
};

// Reads every chunk of every table. `hit`: the only chunk that may be unreadable, or none.
void read_damaged_tables(const std::string& path, TableTally& tally, const Chunk* hit = nullptr) {
  const CFile file(pvb_open(path.c_str()));
  if (!file.error().empty()) {
    ++tally.refused;
    return;
  }
  if (file.info().passes != kPasses) ++tally.wrong;
  for (const Chunk& chunk : chunks_of_tables()) {
    const test::GoldenTable& table = test::golden_tables()[chunk.table];
    for (std::size_t k = 0; k < table.channels.size(); ++k) {
      const Bytes values = test::c_read_from(file.get(), chunk.table, k, chunk.first, chunk.count);
      if (values == test::table_values(chunk.table, k, chunk.first, chunk.count)) continue;
      ++tally.unreadable;
      if (!values.empty()) ++tally.wrong;
      const std::string where = "table " + table.name + ": chunk " + std::to_string(chunk.number) +
                                " (records " + std::to_string(chunk.first) + "-" +
                                std::to_string(chunk.first + chunk.count - 1) + "), channel " +
                                file.info().tables[chunk.table].channels[k].name + ": ";
      tally.unnamed += file.error().find(where) == std::string::npos;
      if (hit != nullptr && (hit->table != chunk.table || hit->number != chunk.number))
        ++tally.wrong;
    }
  }
}

Bytes whole_file(const std::string& path) {
  test::write_tables(path, kPasses);
  return test::load(path);
}

}  // namespace

TEST_CASE("a flipped bit in a chunk of a table is told by table, chunk and channel, or harmless") {
  const test::Scratch scratch;
  const std::string path = scratch.path("f.pvb");
  const Bytes whole = whole_file(path);
  const auto places = test::frames(whole, "TCHK");
  REQUIRE(places.size() == chunks_of_tables().size());
  std::mt19937 random(4);
  TableTally tally;
  for (const auto& place : places) {
    const Chunk chunk = chunk_at(whole, place.offset);
    for (int round = 0; round < 60; ++round) {
      // Half of them in prefix and directory.
      const std::size_t bits = 8 * (round % 2 == 0 ? 64 + 32 + 24 * 19 : place.length);
      const std::size_t bit = random() % bits;
      Bytes bytes = whole;
      bytes[place.offset + bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
      test::save(path, bytes);
      read_damaged_tables(path, tally, &chunk);
    }
  }
  CHECK(tally.refused == 0);
  CHECK(tally.wrong == 0);
  CHECK(tally.unnamed == 0);
  CHECK(tally.unreadable > 100);
}

TEST_CASE("a flipped bit anywhere in a file with tables never gives a wrong value") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.pvb");
  const Bytes whole = whole_file(path);
  TableTally tally;
  for (std::size_t bit = 5; bit < 8 * whole.size(); bit += 1201) {
    Bytes bytes = whole;
    bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    test::save(path, bytes);
    read_damaged_tables(path, tally);
  }
  CHECK(tally.wrong == 0);
  CHECK(tally.unnamed == 0);
  CHECK(tally.refused > 0);
  CHECK(tally.unreadable > 0);
}

TEST_CASE("a chunk of another table, or of the paths, is not taken for one of a table") {
  const test::Scratch scratch;
  const std::string path = scratch.path("k.pvb");
  const Bytes whole = whole_file(path);
  const std::size_t at = test::frames(whole, "TCHK").at(0).offset;
  const auto unreadable = [&](std::size_t field, std::uint64_t value) {
    Bytes bytes = whole;
    test::put(bytes, at + field, 4, value);
    test::mend(bytes, at);
    test::save(path, bytes);
    TableTally tally;
    const Chunk first = chunks_of_tables().at(0);
    read_damaged_tables(path, tally, &first);
    CHECK(tally.wrong + tally.unnamed == 0);
    return tally.unreadable;
  };
  CHECK(unreadable(24, 0x4B4E4843) == 19);  // CHNK
  CHECK(unreadable(84, 2) == 19);           // the number of the table
  CHECK(unreadable(84, 0) == 19);
  CHECK(unreadable(76, 3) == 19);  // the pass
  CHECK(unreadable(88, 77) == 0);  // zero fields are ignored
}

TEST_CASE("where a base of the index is lost, every chunk of a table is found by looking") {
  const test::Scratch scratch;
  const std::string path = scratch.path("b.pvb");
  test::write_tables(path, 8, false);
  const Bytes whole = test::load(path);
  const auto commits = test::frames(whole, "CMIT"), chunks = test::frames(whole, "TCHK");
  Bytes bytes = whole;
  // One that has another number of chunks than the next builds on is no base either.
  test::put(bytes, commits[3].offset + 64 + 176, 8, 5);
  test::mend(bytes, commits[3].offset);
  test::save(path, bytes);
  CHECK(test::table_faults(path, 8) == "");
  bytes[commits[3].offset] = std::byte{0};
  test::save(path, bytes);
  CHECK(test::table_faults(path, 8) == "");
  bytes[chunks[1].offset] = std::byte{0};  // of pass 2; its place is still in an index
  test::save(path, bytes);
  {
    const CFile file(pvb_open(path.c_str()));
    CHECK(file.error() == "");
    CHECK((test::c_read_from(file.get(), 0, 0, 0, 11) == test::table_values(0, 0, 0, 11)));
    CHECK(test::c_read_from(file.get(), 0, 0, 11, 1).empty());
    CHECK((test::c_read_from(file.get(), 0, 0, 33, 33) == test::table_values(0, 0, 33, 33)));
  }
  bytes[commits[2].offset] = std::byte{0};  // the only one that has it
  test::save(path, bytes);
  CHECK(CFile(pvb_open(path.c_str()))
            .error()
            .find("damaged: table vertices: the chunk with record 11 ") != std::string::npos);
}

TEST_CASE("impossible tables in HEAD and impossible totals are an error, whatever they are") {
  const test::Scratch scratch;
  const std::string path = scratch.path("i.pvb");
  const Bytes whole = whole_file(path);
  const std::size_t tables = 64 + 64 + 64 * 19 + test::golden_head().metadata.size();
  REQUIRE(test::get(whole, tables, 4) == 2);
  const auto error = [&](std::size_t frame, std::size_t at, std::size_t size, std::uint64_t value) {
    Bytes bytes = whole;
    test::put(bytes, at, size, value);
    test::mend(bytes, frame);
    test::save(path, bytes);
    return CFile(pvb_open(path.c_str())).error();
  };
  for (const std::uint64_t value : {0u, 3u, 16u, 17u, 0xFFFFFFFFu}) {
    CHECK_FALSE(error(0, tables, 4, value).empty());
  }
  CHECK(error(0, tables, 4, 1).find("cannot be read") == std::string::npos);
  CHECK_FALSE(error(0, tables + 8, 8, 0).empty());  // name
  CHECK_FALSE(error(0, tables + 8 + 10, 1, 'x').empty());
  CHECK_FALSE(error(0, tables + 8 + 56, 4, 0).empty());  // capacity
  CHECK_FALSE(error(0, tables + 8 + 56, 4, (1u << 24) + 1).empty());
  for (const std::uint64_t value : {0u, 18u, 20u, 257u, 0xFFFFFFFFu}) {  // number of channels
    CHECK_FALSE(error(0, tables + 8 + 60, 4, value).empty());
  }
  CHECK_FALSE(error(0, 56, 4, tables - 64 + 7).empty());  // ends within the tables
  CHECK(error(0, tables + 4, 4, 9).empty());              // zero
  // The same where the name of the first table is that of the second, or of the paths.
  Bytes bytes = whole;
  for (const std::string name : {"photons", "paths"}) {
    for (std::size_t k = 0; k < 8; ++k) {
      test::put(bytes, tables + 8 + k, 1,
                k < name.size() ? static_cast<unsigned char>(name[k]) : 0);
    }
    test::mend(bytes, 0);
    test::save(path, bytes);
    CHECK_FALSE(CFile(pvb_open(path.c_str())).error().empty());
  }

  const std::size_t last = test::frames(whole, "CMIT").back().offset;
  std::size_t tried = 0;
  for (const std::size_t at : {160u, 168u, 176u, 184u, 200u, 208u, 216u}) {
    for (const std::uint64_t value :
         {std::uint64_t{1}, std::uint64_t{5}, std::uint64_t{1} << 31, std::uint64_t{1} << 32,
          std::uint64_t{1} << 59, std::uint64_t{1} << 63, ~std::uint64_t{0}}) {
      CAPTURE(at, value);
      CHECK_FALSE(error(last, last + 64 + at, at == 160 ? 4 : 8, value).empty());
      ++tried;
    }
  }
  CHECK(tried == 49);
  CHECK_FALSE(error(last, last + 56, 4, 167).empty());  // a shorter directory
}
