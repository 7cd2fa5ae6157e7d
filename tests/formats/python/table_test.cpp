// Tables: what the C header and pvb.py write, each reads, and so does the reader that was written from
// the specification; every type and encoding.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "../c/table_file.h"
#include "catch.h"
#include "tool.h"

using namespace psf;

namespace {

constexpr std::size_t kPasses = 6;

// What the independent reader prints.
std::string read_from_the_spec(const test::Scratch& scratch, const std::string& path) {
  const std::string out = scratch.path("independent");
  const std::string line =
      fmt::format("python3 '{}/tests/formats/read_pvb.py' '{}' >'{}'", PSF_SOURCE_DIR, path, out);
  REQUIRE(std::system(line.c_str()) == 0);
  std::ifstream in(out);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("tables that the C header writes are read by pvb.py and from the spec alone") {
  const test::Scratch scratch;
  const std::string path = scratch.path("c.pvb");
  for (const std::size_t passes : {std::size_t{1}, kPasses, std::size_t{70}}) {
    for (const bool closed : {true, false}) {
      test::write_tables(path, passes, closed);
      const std::string expected = test::tables_dump(passes);
      CHECK((read_from_the_spec(scratch, path) == expected));
      if (!test::codecs().empty()) {
        CHECK((test::run_tool(scratch, fmt::format("dump '{}'", path)) == expected));
      }
    }
  }
  if (test::codecs().empty()) SKIP(test::kNoNumpy);
}

TEST_CASE("tables that pvb.py writes are read by the C header and from the spec alone") {
  const std::vector<std::string> codecs = test::codecs();
  if (codecs.empty()) SKIP(test::kNoNumpy);
  const test::Scratch scratch;
  const std::string path = scratch.path("p.pvb"), own = scratch.path("c.pvb");
  for (const std::string& codec : codecs) {
    test::run_tool(scratch, fmt::format("tables {} '{}' {}", codec, path, kPasses));
    const bool has_zstd = std::system("zstd --version >/dev/null 2>&1") == 0;
    if (codec == "raw" || has_zstd) {
      CHECK((read_from_the_spec(scratch, path) == test::tables_dump(kPasses)));
    }
    if (codec == "raw") {
      CHECK(test::table_faults(path, kPasses) == "");
      // Raw files are the same to the last byte, whoever wrote them.
      test::write_tables(own, kPasses);
      CHECK((test::load(path) == test::load(own)));
      continue;
    }
    const test::CFile file(pvb_open(path.c_str()));
    REQUIRE(file.error().empty());
    CHECK(file.info().tables[0].records == test::records_before(0, kPasses));
    CHECK(test::c_read_from(file.get(), 0, 0, 0, 1).empty());
    CHECK(
        file.error().find("table vertices: chunk 0 (records 0-10), channel position: compressed") !=
        std::string::npos);
  }
  if (codecs.size() < 2) SKIP(test::kNoZstandard);
}

TEST_CASE("the golden files of version 1.1 are read by pvb.py and from the spec alone") {
  const test::Scratch scratch;
  const std::string folder = PSF_SOURCE_DIR "/sample_data/", expected = test::tables_dump(5);
  const bool has_zstd = std::system("zstd --version >/dev/null 2>&1") == 0;
  for (const std::string codec : {"raw", "zstd"}) {
    const std::string path = folder + "golden-tables-" + codec + ".pvb";
    if (codec == "raw" || has_zstd) CHECK((read_from_the_spec(scratch, path) == expected));
  }
  for (const std::string& codec : test::codecs()) {
    const std::string path = folder + "golden-tables-" + codec + ".pvb";
    CHECK((test::run_tool(scratch, fmt::format("dump '{}'", path)) == expected));
  }
  if (test::codecs().empty()) SKIP(test::kNoNumpy);
}

TEST_CASE("the C header and pvb.py go on with each other's tables") {
  if (test::codecs().empty()) SKIP(test::kNoNumpy);
  const test::Scratch scratch;
  const std::string path = scratch.path("g.pvb");
  test::run_tool(scratch, fmt::format("tables raw '{}' 3", path));
  for (std::size_t pass = 3; pass < kPasses; ++pass) {
    const test::CFile file(test::resume_tables(path));
    REQUIRE(file.error().empty());
    test::write_tables_pass(file.get(), pass);
  }
  CHECK((test::run_tool(scratch, fmt::format("dump '{}'", path)) == test::tables_dump(kPasses)));
  CHECK((read_from_the_spec(scratch, path) == test::tables_dump(kPasses)));
}
