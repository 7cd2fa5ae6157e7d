// What is written is what is read: every type, width, codec and encoding, over chunks and passes,
// bit for bit.
#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/layout/quantize.h"
#include "formats/read/reader.h"
#include "formats/write/writer.h"
#include "golden.h"

using namespace psf;
using namespace psf::formats;

namespace {

constexpr std::array kTypes = {Type::u8,  Type::u16, Type::u32, Type::u64,
                               Type::f16, Type::f32, Type::f64};

// Every type with 1 to 16 components, values of all bit patterns: NaN with payloads among them.
Head every_type(std::uint32_t capacity) {
  Head head;
  head.channels.clear();
  head.chunk_capacity = capacity;
  for (const Type type : kTypes) {
    for (std::uint8_t c = 1; c <= 16; ++c) {
      head.channels.push_back({std::string(name_of(type)) + "x" + std::to_string(c), type, c});
    }
  }
  head.channels.push_back({"oct", Type::u16, 2, Encoding::octahedral});
  return head;
}

std::vector<test::Bytes> random_columns(const Head& head, std::size_t records, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<test::Bytes> columns;
  for (const Channel& channel : head.channels) {
    test::Bytes bytes(records * channel.stride());
    const bool dull = random() % 2 == 0;  // so that zstd shrinks it
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(dull ? random() % 2 : random());
    columns.push_back(std::move(bytes));
  }
  return columns;
}

void append(Writer& writer, const Head& head, const std::vector<test::Bytes>& columns,
            std::size_t first, std::size_t count) {
  std::vector<const void*> pointers;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    pointers.push_back(columns[k].data() + first * head.channels[k].stride());
  }
  writer.append(count, pointers);
}

}  // namespace

TEST_CASE("every type, width and codec comes back bit for bit, whatever the pieces") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.pvb");
  const std::size_t records = 1000;
  for (const Codec codec : {Codec::raw, Codec::zstd}) {
    for (const std::uint32_t capacity : {1u << 16, 128u, 100u, 7u}) {
      const Head head = every_type(capacity);
      const auto columns = random_columns(head, records, capacity);
      std::mt19937 random(capacity);
      {
        Writer writer(path, head, {codec, false, {}});
        std::size_t done = 0, pass_left = 300;
        while (done < records) {
          const std::size_t piece =
              std::min({records - done, pass_left, std::size_t{random() % 150}});
          append(writer, head, columns, done, piece);
          done += piece;
          pass_left -= piece;
          if (pass_left > 0 && done < records) continue;
          writer.commit();
          CHECK(writer.records() == done);
          pass_left = 300;
        }
        writer.close();
      }
      const Reader reader(path);
      CHECK(reader.head().channels == head.channels);
      REQUIRE(reader.records() == records);
      CHECK(reader.closed());
      CHECK(reader.uncommitted_bytes() == 0);
      REQUIRE(reader.passes().size() == 4);
      CHECK(reader.passes()[3].first == 900);
      CHECK(reader.passes()[3].count == 100);
      for (std::size_t k = 0; k < head.channels.size(); ++k) {
        const bool same = test::read_all(reader, k) == columns[k];
        CAPTURE(head.channels[k].name);
        CHECK(same);
      }
    }
  }
}

TEST_CASE("any range of a channel is the same part of the whole") {
  const test::Scratch scratch;
  test::write_golden(scratch.path("g.pvb"), Codec::zstd);
  const Reader reader(scratch.path("g.pvb"));
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < reader.head().channels.size(); ++k) {
    const std::size_t stride = reader.head().channels[k].stride();
    for (std::size_t first = 0; first <= test::kGoldenRecords; ++first) {
      for (std::size_t count = 0; first + count <= test::kGoldenRecords; count += 1 + count / 3) {
        test::Bytes out(count * stride);
        reader.read(k, first, count, out);
        if (out != test::golden_values(k, first, count)) ++wrong;
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("floats are read from every floating-point type and encoding") {
  const test::Scratch scratch;
  Head head;
  head.chunk_capacity = 5;
  head.channels = {{"f32", Type::f32, 2},
                   {"f64", Type::f64, 2},
                   {"f16", Type::f16, 2},
                   {"oct", Type::u16, 2, Encoding::octahedral},
                   {"u32", Type::u32, 1}};
  const std::size_t count = 12;
  std::vector<float> f32(2 * count);
  std::vector<double> f64(2 * count);
  std::vector<std::uint16_t> f16(2 * count), oct(2 * count);
  std::vector<std::uint32_t> u32(count);
  for (std::size_t k = 0; k < 2 * count; ++k) {
    f32[k] = static_cast<float>(k) / 7;
    f64[k] = static_cast<double>(k) / 7;
    f16[k] = static_cast<std::uint16_t>(0x3C00 + k * 64);  // 1, 1.0625, ...
    oct[k] = static_cast<std::uint16_t>(1000 * k);
  }
  const std::uint32_t payload = 0x7FA00001;
  std::memcpy(&f32[3], &payload, 4);
  f64[5] = std::numeric_limits<double>::infinity();
  {
    Writer writer(scratch.path("f.pvb"), head, {Codec::raw, false, {}});
    const std::array<const void*, 5> columns = {f32.data(), f64.data(), f16.data(), oct.data(),
                                                u32.data()};
    writer.append(count, columns);
    writer.commit();
  }
  const Reader reader(scratch.path("f.pvb"));
  std::vector<float> out(2 * 9), directions(3 * 9), expected(3 * 9);
  reader.read_floats(0, 2, 9, out);
  CHECK(std::memcmp(out.data(), f32.data() + 4, 18 * 4) == 0);
  reader.read_floats(0, 1, 9, out);
  CHECK(std::memcmp(out.data(), f32.data() + 2, 18 * 4) == 0);
  reader.read_floats(1, 2, 9, out);
  for (std::size_t k = 0; k < 18; ++k) CHECK(out[k] == static_cast<float>(f64[k + 4]));
  reader.read_floats(2, 2, 9, out);
  for (std::size_t k = 0; k < 12; ++k) CHECK(out[k] == 1 + static_cast<float>(k + 4) / 16);
  for (std::size_t k = 12; k < 18; ++k) CHECK(out[k] == 2 + static_cast<float>(k - 12) / 8);
  reader.read_floats(3, 2, 9, directions);
  decode_octahedral(std::span(oct).subspan(4, 18), expected);
  CHECK(directions == expected);
  CHECK_THROWS_AS(reader.read_floats(4, 2, 9, out), Error);
  CHECK_THROWS_AS(reader.read_floats(0, 2, 8, out), Error);
  CHECK_THROWS_AS(reader.read_floats(0, 4, 9, out), Error);
}

TEST_CASE("a channel that is missing is an error that says who needs it") {
  const test::Scratch scratch;
  test::write_golden(scratch.path("g.pvb"), Codec::raw);
  const Reader reader(scratch.path("g.pvb"));
  CHECK(reader.require("contribution", "the filter") == 4);
  try {
    static_cast<void>(reader.require("motion", "--motion"));
    FAIL("no error");
  } catch (const Error& error) {
    const std::string text = error.what();
    CHECK(error.code() == ErrorCode::bad_input);
    CHECK(text.find("g.pvb") != std::string::npos);
    CHECK(text.find("motion, which --motion needs") != std::string::npos);
  }
}
