// formats/pvb.py and the C++ library write and read each other's files: identical values, no
// faults.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>

#include "../file_bytes.h"
#include "../golden.h"
#include "catch.h"
#include "formats/check/check.h"
#include "formats/layout/quantize.h"
#include "formats/read/reader.h"
#include "tool.h"

using namespace psf;
using namespace psf::formats;
using test::codecs;
using test::hex;
using test::run_tool;

namespace {

// Every code of two bytes in each component once, and the marks with all kinds of partners.
std::vector<std::uint16_t> many_codes() {
  std::mt19937 random(1);
  std::vector<std::uint16_t> codes;
  for (std::uint32_t k = 0; k < 65536; ++k) {
    const auto any = static_cast<std::uint16_t>(random());
    const auto code = static_cast<std::uint16_t>(k);
    codes.insert(codes.end(), {code, any, any, code, code, code});
    codes.insert(codes.end(), {65535, code, code, 65535});
  }
  return codes;
}

std::vector<float> many_vectors() {
  std::mt19937 random(2);
  std::vector<float> values;
  const auto bits = [&](std::uint32_t pattern) {
    float value = 0;
    std::memcpy(&value, &pattern, 4);
    values.push_back(value);
  };
  for (int k = 0; k < 300000; ++k) {  // any bits: huge, tiny, NaN, infinite
    bits(static_cast<std::uint32_t>(random()));
  }
  std::normal_distribution<float> normal;
  for (int k = 0; k < 300000; ++k) values.push_back(normal(random));
  for (const float x : {-1.0f, -0.0f, 0.0f, 1.0f}) {
    for (const float y : {-1.0f, -0.0f, 0.0f, 1.0f}) {
      for (const float z : {-1.0f, -0.0f, 0.0f, 1.0f}) values.insert(values.end(), {x, y, z});
    }
  }
  return values;
}

void write_channel(const std::string& path, const Channel& channel, const void* values,
                   std::size_t count) {
  Head head;
  head.chunk_capacity = 1000;
  head.channels = {channel};
  Writer writer(path, head, {Codec::raw, false, {}});
  writer.append(count, std::array{values});
  writer.commit();
  writer.close();
}

}  // namespace

TEST_CASE("what pvb.py writes the library reads, and finds no fault") {
  if (codecs().empty()) SKIP(test::kNoNumpy);
  for (const std::string& codec : codecs()) {
    CAPTURE(codec);
    const test::Scratch scratch;
    const std::string path = scratch.path("x.pvb");
    run_tool(scratch, fmt::format("golden {} '{}'", codec, path));
    const Reader reader(path);
    CHECK(reader.closed());
    CHECK(reader.records() == test::kGoldenRecords);
    CHECK(reader.passes().size() == test::kGoldenPasses);
    CHECK(reader.head().channels == test::golden_head().channels);
    CHECK(reader.head().metadata == test::golden_head().metadata);
    bool compressed = false;
    for (const Column& column : reader.columns(0)) compressed |= column.codec == Codec::zstd;
    CHECK(compressed == (codec == "zstd"));
    for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
      CAPTURE(reader.head().channels[k].name);
      const bool same =
          test::read_all(reader, k) == test::golden_values(k, 0, test::kGoldenRecords);
      CHECK(same);
    }
    CHECK(check(path).faults.empty());
  }
  if (codecs().size() < 2) SKIP(test::kNoZstandard);
}

TEST_CASE("what the library writes pvb.py reads") {
  if (codecs().empty()) SKIP(test::kNoNumpy);
  for (const std::string& codec : codecs()) {
    CAPTURE(codec);
    const test::Scratch scratch;
    const std::string path = scratch.path("x.pvb");
    test::write_golden(path, codec == "raw" ? Codec::raw : Codec::zstd);
    std::istringstream lines(run_tool(scratch, fmt::format("dump '{}'", path)));
    std::string name, type, components, encoding, values;
    std::size_t k = 0;
    for (; lines >> name >> type >> components >> encoding >> values; ++k) {
      REQUIRE(k < test::golden_head().channels.size());
      const Channel channel = test::golden_head().channels[k];
      CAPTURE(name);
      CHECK(name == channel.name);
      CHECK(type == name_of(channel.type));
      CHECK(components == std::to_string(channel.components));
      CHECK(encoding == (channel.encoding == Encoding::plain ? "plain" : "octahedral"));
      const bool same = values == hex(test::golden_values(k, 0, test::kGoldenRecords));
      CHECK(same);
    }
    CHECK(k == test::golden_head().channels.size());
  }
  if (codecs().size() < 2) SKIP(test::kNoZstandard);
}

TEST_CASE("pvb.py decodes octahedral vectors to the library's bits") {
  if (codecs().empty()) SKIP(test::kNoNumpy);
  const test::Scratch scratch;
  const std::vector<std::uint16_t> codes = many_codes();
  const std::size_t count = codes.size() / 2;
  const std::string path = scratch.path("x.pvb"), out = scratch.path("floats");
  write_channel(path, {"n", Type::u16, 2, Encoding::octahedral}, codes.data(), count);
  run_tool(scratch, fmt::format("floats '{}' n '{}'", path, out));
  std::vector<float> expected(count * 3);
  Reader(path).read_floats(0, 0, count, expected);
  const test::Bytes found = test::load(out);
  REQUIRE(found.size() == expected.size() * sizeof(float));
  CHECK(std::memcmp(found.data(), expected.data(), found.size()) == 0);
}

TEST_CASE("pvb.py encodes octahedral vectors and halves to the library's codes") {
  if (codecs().empty()) SKIP(test::kNoNumpy);
  const test::Scratch scratch;
  const std::vector<float> vectors = many_vectors();
  const std::size_t count = vectors.size() / 3;
  write_channel(scratch.path("in.pvb"), {"vector", Type::f32, 3}, vectors.data(), count);
  run_tool(scratch, fmt::format("encode '{}' '{}'", scratch.path("in.pvb"), scratch.path("x.pvb")));
  const Reader reader(scratch.path("x.pvb"));
  std::vector<std::uint16_t> codes(count * 2), found(count * 2);
  encode_octahedral(vectors, codes);
  reader.read(0, 0, count, std::as_writable_bytes(std::span(found)));
  CHECK((found == codes));
  std::vector<std::uint16_t> halves(count * 3), found_halves(count * 3);
  encode_half(vectors, halves);
  reader.read(1, 0, count, std::as_writable_bytes(std::span(found_halves)));
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < halves.size(); ++k) {
    // Which bits of a NaN's payload survive is nobody's promise.
    if (!std::isnan(vectors[k]) && halves[k] != found_halves[k]) ++wrong;
  }
  CHECK(wrong == 0);
}
