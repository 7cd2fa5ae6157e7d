// Tables through C++ and the C header: the same files from both, and golden files of version 1.1.
#include "catch.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "formats/write/writer.h"
#include "golden.h"
#include "table_file.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::size_t kGoldenTablePasses = 5;
const std::string kRaw = PSF_SOURCE_DIR "/sample_data/golden-tables-raw.pvb";
const std::string kZstd = PSF_SOURCE_DIR "/sample_data/golden-tables-zstd.pvb";

Head head_with_tables() {
  Head head = test::golden_head();
  for (const test::GoldenTable& golden : test::golden_tables()) {
    Table table;
    table.name = golden.name;
    table.chunk_capacity = golden.capacity;
    for (const std::size_t k : golden.channels) table.channels.push_back(head.channels[k]);
    head.tables.push_back(table);
  }
  return head;
}

void append_columns(Writer& writer, std::size_t table, std::size_t count,
                    const std::vector<test::Bytes>& columns) {
  std::vector<const void*> pointers;
  for (const test::Bytes& column : columns) pointers.push_back(column.data());
  writer.append_to(table, count, pointers);
}

void write_with_cpp(const std::string& path, Codec codec) {
  Writer writer(path, head_with_tables(), {codec, false, test::golden_uuid()});
  for (std::size_t pass = 0; pass < kGoldenTablePasses; ++pass) {
    std::vector<test::Bytes> columns;
    for (std::size_t k = 0; k < writer.head().channels.size(); ++k) {
      columns.push_back(test::golden_values(k, pass * test::kGoldenPass, test::kGoldenPass));
    }
    append_columns(writer, 0, test::kGoldenPass, columns);
    for (std::size_t t = 0; t < test::golden_tables().size(); ++t) {
      const std::size_t count = test::table_records(t, pass);
      columns.clear();
      for (std::size_t k = 0; k < test::golden_tables()[t].channels.size(); ++k) {
        columns.push_back(test::table_values(t, k, test::records_before(t, pass), count));
      }
      append_columns(writer, t + 1, count, columns);
    }
    const std::string state = "resume " + std::to_string(pass);
    writer.commit(std::as_bytes(std::span(state)));
  }
  writer.close();
}

// What C++ finds wrong in a file; empty where it is the golden one.
std::string faults_for_cpp(const std::string& path) {
  const auto faults = check(path).faults;
  if (!faults.empty()) return faults[0].text();
  const Reader reader(path);
  if (reader.passes().size() != kGoldenTablePasses) return "passes";
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    if (test::read_all(reader, k) != test::golden_values(k, 0, reader.records())) return "paths";
  }
  if (reader.head().tables != head_with_tables().tables) return "tables";
  for (std::size_t t = 0; t < test::golden_tables().size(); ++t) {
    const TableReader& table = reader.table(t + 1);
    if (table.records() != test::records_before(t, kGoldenTablePasses)) return "records";
    for (std::size_t k = 0; k < table.schema().channels.size(); ++k) {
      test::Bytes values(table.records() * table.schema().channels[k].stride());
      table.read(k, 0, table.records(), values);
      if (values != test::table_values(t, k, 0, table.records())) {
        return std::string(table.name()) + ": " + table.schema().channels[k].name;
      }
    }
  }
  return "";
}

}  // namespace

TEST_CASE("C++ and the C header write the same files with tables, and read each other's") {
  const test::Scratch scratch;
  const std::string cpp = scratch.path("cpp.pvb"), c = scratch.path("c.pvb");
  write_with_cpp(cpp, Codec::raw);
  test::write_tables(c, kGoldenTablePasses);
  CHECK((test::load(cpp) == test::load(c)));
  CHECK(faults_for_cpp(c).empty());
  CHECK(test::table_faults(cpp, kGoldenTablePasses).empty());
  write_with_cpp(cpp, Codec::zstd);
  CHECK(faults_for_cpp(cpp).empty());
}

TEST_CASE("the golden files of version 1.1 are read, and the raw one is made again") {
  const test::Scratch scratch;
  const std::string made = scratch.path("made.pvb");
  CHECK(faults_for_cpp(kRaw).empty());
  CHECK(faults_for_cpp(kZstd).empty());
  CHECK(test::table_faults(kRaw, kGoldenTablePasses).empty());
  write_with_cpp(made, Codec::raw);
  CHECK((test::load(made) == test::load(kRaw)));
}

// Makes the golden files, which are of their version for good.
TEST_CASE("the golden files of version 1.1 are written", "[.][make]") {
  write_with_cpp(kRaw, Codec::raw);
  write_with_cpp(kZstd, Codec::zstd);
}
