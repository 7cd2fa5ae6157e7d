// The golden files of sample_data, read by this library, by a reader that knows only the spec, and
// made again.
#include "golden.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "catch.h"
#include "file_bytes.h"
#include "formats/check/check.h"
#include "formats/read/reader.h"

using namespace psf;
using namespace psf::formats;

namespace {

const std::string kData = PSF_SOURCE_DIR "/sample_data/";
const std::string kScript = PSF_SOURCE_DIR "/tests/formats/read_pvb.py";

std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::array<char, 4096> buffer;
  for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    text.append(buffer.data(), got);
  }
  CHECK(::pclose(pipe) == 0);
  return text;
}

std::string hex(const test::Bytes& bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    text += "0123456789abcdef"[std::to_integer<unsigned>(byte) >> 4];
    text += "0123456789abcdef"[std::to_integer<unsigned>(byte) & 15];
  }
  return text;
}

}  // namespace

TEST_CASE("golden files hold the expected values") {
  for (const std::string name : {"golden-raw.pvb", "golden-zstd.pvb", "golden-tail.pvb"}) {
    CAPTURE(name);
    const Reader reader(kData + name);
    CHECK(reader.records() == test::kGoldenRecords);
    CHECK(reader.closed() == (name != "golden-tail.pvb"));
    CHECK((reader.uncommitted_bytes() > 0) == (name == "golden-tail.pvb"));
    CHECK(reader.head().channels == test::golden_head().channels);
    CHECK(reader.head().metadata == test::golden_head().metadata);
    CHECK(reader.uuid() == "901de000-0000-4000-8000-000000000001");
    for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
      const bool same =
          test::read_all(reader, k) == test::golden_values(k, 0, test::kGoldenRecords);
      CHECK(same);
    }
    CHECK(check(kData + name).faults.empty());
  }
}

TEST_CASE("the raw golden files are made again byte for byte") {
  const test::Scratch scratch;
  test::write_golden(scratch.path("raw.pvb"), Codec::raw);
  const bool raw = test::load(scratch.path("raw.pvb")) == test::load(kData + "golden-raw.pvb");
  CHECK(raw);
  test::write_golden_tail(scratch.path("tail.pvb"));
  const bool tail = test::load(scratch.path("tail.pvb")) == test::load(kData + "golden-tail.pvb");
  CHECK(tail);
}

TEST_CASE("a reader written from the spec alone gets every value") {
  if (std::system("python3 -c '' 2>/dev/null") != 0) SKIP("no python3 for the independent reader");
  const bool has_zstd = std::system("zstd --version >/dev/null 2>&1") == 0;
  std::vector<std::string> names = {"golden-raw.pvb", "golden-tail.pvb"};
  if (has_zstd) names.push_back("golden-zstd.pvb");
  for (const std::string& name : names) {
    std::istringstream lines(output_of(fmt::format("python3 '{}' '{}{}'", kScript, kData, name)));
    const Head head = test::golden_head();
    std::string channel, type, components, encoding, values;
    std::size_t k = 0;
    for (; lines >> channel >> type >> components >> encoding >> values; ++k) {
      REQUIRE(k < head.channels.size());
      CHECK(channel == head.channels[k].name);
      CHECK(type == name_of(head.channels[k].type));
      CHECK(components == std::to_string(head.channels[k].components));
      CHECK(encoding == (head.channels[k].encoding == Encoding::plain ? "plain" : "octahedral"));
      const bool same = values == hex(test::golden_values(k, 0, test::kGoldenRecords));
      CHECK(same);
    }
    CHECK(k == head.channels.size());
  }
  if (!has_zstd) SKIP("no zstd: the independent reader did not read the compressed file");
}

TEST_CASE("the example of the spec is what the writer writes") {
  const test::Scratch scratch;
  test::write_example(scratch.path("example.pvb"));
  std::ifstream in(PSF_SOURCE_DIR "/formats/README.md");
  const std::string spec((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  // Rows stand in the spec in this order, with headings between them.
  std::istringstream rows(test::hex_dump(scratch.path("example.pvb")));
  std::size_t place = 0, count = 0;
  for (std::string row; std::getline(rows, row); ++count) {
    CAPTURE(row);
    place = spec.find(row, place);
    REQUIRE(place != std::string::npos);
  }
  CHECK(count > 20);
}
