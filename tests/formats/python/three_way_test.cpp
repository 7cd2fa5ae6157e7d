// The C header, the C++ library and pvb.py: what each writes, each reads, all types and encodings.
#include <fmt/format.h>

#include <functional>
#include <sstream>

#include "../c/c_file.h"
#include "../golden.h"
#include "catch.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"
#include "tool.h"

using namespace psf;
using namespace psf::formats;

namespace {

using Values = std::vector<std::string>;  // hexadecimal, by channel

Values expected_values() {
  Values values;
  for (std::size_t k = 0; k < test::golden_head().channels.size(); ++k) {
    values.push_back(test::hex(test::golden_values(k, 0, test::kGoldenRecords)));
  }
  return values;
}

Values read_cpp(const std::string& path) {
  const Reader reader(path);
  Values values;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    values.push_back(test::hex(test::read_all(reader, k)));
  }
  return values;
}

Values read_numpy(const test::Scratch& scratch, const std::string& path) {
  std::istringstream lines(test::run_tool(scratch, fmt::format("dump '{}'", path)));
  Values values;
  for (std::string line; std::getline(lines, line);) {
    values.push_back(line.substr(line.rfind(' ') + 1));
  }
  return values;
}

// Columns that it says are compressed become empty; it reads none of those.
Values read_c(const std::string& path) {
  Values values;
  for (std::size_t k = 0; k < test::golden_head().channels.size(); ++k) {
    const test::CFile file(pvb_open(path.c_str()));  // an error sticks
    REQUIRE(file.error().empty());
    values.push_back(test::hex(test::c_read(file.get(), k, 0, test::kGoldenRecords)));
    if (!file.error().empty()) {
      CHECK(values.back().empty());
      CHECK(file.error().find("compressed with zstd") != std::string::npos);
    }
  }
  return values;
}

void write_c(const std::string& path) {
  const test::CFile file(test::create_golden(path));
  for (std::size_t pass = 0; pass < test::kGoldenPasses; ++pass) {
    REQUIRE(test::write_golden_pass(file.get(), pass) == 0);
  }
  REQUIRE(pvb_close(file.get()) == 0);
}

}  // namespace

TEST_CASE("C, C++ and numpy write and read each other's files") {
  const std::vector<std::string> codecs = test::codecs();
  if (codecs.empty()) SKIP(test::kNoNumpy);
  const test::Scratch scratch;
  const std::string path = scratch.path("x.pvb");
  const Values expected = expected_values();
  struct Writing {
    std::string who, codec;
    std::function<void()> write;
  };
  std::vector<Writing> writings = {{"C", "raw", [&] { write_c(path); }}};
  for (const std::string& codec : codecs) {
    writings.push_back({"C++", codec, [&path, codec] {
                          test::write_golden(path, codec == "raw" ? Codec::raw : Codec::zstd);
                        }});
    writings.push_back({"numpy", codec, [&scratch, &path, codec] {
                          test::run_tool(scratch, fmt::format("golden {} '{}'", codec, path));
                        }});
  }
  test::Bytes first;
  for (const Writing& writing : writings) {
    CAPTURE(writing.who, writing.codec);
    writing.write();
    CHECK((read_cpp(path) == expected));
    CHECK((read_numpy(scratch, path) == expected));
    const Values c = read_c(path);
    REQUIRE(c.size() == expected.size());
    std::size_t read = 0;
    for (std::size_t k = 0; k < c.size(); ++k) {
      if (c[k].empty()) continue;
      CHECK((c[k] == expected[k]));
      ++read;
    }
    CHECK((writing.codec == "raw" ? read == c.size() : read > 0 && read < c.size()));
    CHECK(check(path).faults.empty());
    if (writing.codec != "raw") continue;
    // Raw files are the same to the last byte, whoever wrote them.
    if (first.empty()) first = test::load(path);
    CHECK((test::load(path) == first));
  }
  if (codecs.size() < 2) SKIP(test::kNoZstandard);
}
