// Checksums, shuffle and zstd against their definitions.
#include "formats/layout/codec.h"

#include <random>

#include "catch.h"
#include "core/error.h"
#include "file_bytes.h"
#include "formats/layout/chunk.h"
#include "formats/layout/crc.h"
#include "formats/layout/layout.h"

using namespace psf;
using namespace psf::formats;

namespace {

test::Bytes random_bytes(std::size_t size, unsigned seed, unsigned range = 256) {
  std::mt19937 random(seed);
  test::Bytes bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % range);
  return bytes;
}

}  // namespace

TEST_CASE("crc32 is zlib's, in pieces or whole") {
  for (std::size_t size : {0u, 1u, 3u, 4u, 63u, 64u, 65u, 1000u, 5000u}) {
    const test::Bytes bytes = random_bytes(size, static_cast<unsigned>(size));
    CHECK(crc32(bytes) == test::slow_crc(bytes));
    const auto all = std::span<const std::byte>(bytes);
    CHECK(crc32(crc32(all.first(size / 3)), all.subspan(size / 3)) == test::slow_crc(bytes));
  }
  const std::string check = "123456789";
  CHECK(crc32(std::as_bytes(std::span(check))) == 0xCBF43926u);
}

TEST_CASE("shuffle4 puts byte k of all words together and leaves the rest behind them") {
  for (std::size_t size : {0u, 1u, 3u, 4u, 5u, 7u, 8u, 64u, 1001u, 4099u}) {
    const test::Bytes in = random_bytes(size, 7);
    test::Bytes out(size), back(size);
    shuffle4(in, out);
    const std::size_t words = size / 4;
    bool right = true;
    for (std::size_t i = 0; i < words; ++i) {
      for (std::size_t k = 0; k < 4; ++k) right = right && out[k * words + i] == in[4 * i + k];
    }
    for (std::size_t i = 4 * words; i < size; ++i) right = right && out[i] == in[i];
    CHECK(right);
    unshuffle4(out, back);
    CHECK(back == in);
  }
}

TEST_CASE("a column of zeros is told by its zstd bytes, and one with any other byte is not") {
  for (std::size_t size : {64u, 100u, 4096u, 100003u}) {
    test::Bytes raw(size);
    Buffer storage;
    const auto is_zero = [&] {
      const EncodedColumn column = encode_column(Codec::zstd, raw, storage);
      REQUIRE(column.codec == Codec::zstd);
      return decodes_to_zeros(column.bytes, size);
    };
    CHECK(is_zero());
    for (std::size_t place : {std::size_t{0}, size / 2, size - 1}) {
      raw[place] = std::byte{0x80};
      CHECK_FALSE(is_zero());
      raw[place] = std::byte{0};
    }
    const EncodedColumn column = encode_column(Codec::zstd, raw, storage);
    CHECK_THROWS_AS(decodes_to_zeros(column.bytes, size + 1), Error);
    CHECK_THROWS_AS(decodes_to_zeros(column.bytes.first(column.bytes.size() - 1), size), Error);
  }
}

TEST_CASE("a column comes back from either codec, and zstd is left where it gains nothing") {
  for (std::size_t size : {1u, 2u, 3u, 12u, 100u, 4096u, 100003u}) {
    for (unsigned range : {1u, 4u, 256u}) {
      const test::Bytes raw = random_bytes(size, 3, range);
      Buffer storage;
      const EncodedColumn column = encode_column(Codec::zstd, raw, storage);
      CHECK(column.crc == test::slow_crc(column.bytes));
      if (column.codec == Codec::raw) {
        CHECK(test::Bytes(column.bytes.begin(), column.bytes.end()) == raw);
        continue;
      }
      CHECK(column.bytes.size() < size);
      test::Bytes back(size);
      decode_zstd(column.bytes, column.filter, back);
      CHECK(back == raw);
      CHECK((range < 256 || size < 100));
      test::Bytes longer(size + 1), shorter(size - 1);
      CHECK_THROWS_AS(decode_zstd(column.bytes, column.filter, longer), Error);
      CHECK_THROWS_AS(decode_zstd(column.bytes, column.filter, shorter), Error);
    }
  }
}

TEST_CASE("several Zstandard frames in a row are no column, even where their sizes add up") {
  const test::Bytes raw(1000, std::byte{7});
  Buffer storage;
  const EncodedColumn column = encode_column(Codec::zstd, raw, storage);
  const test::Bytes one(column.bytes.begin(), column.bytes.end());
  // A frame to be skipped, of no bytes.
  const test::Bytes nothing = {std::byte{0x50}, std::byte{0x2A}, std::byte{0x4D}, std::byte{0x18},
                               std::byte{0},    std::byte{0},    std::byte{0},    std::byte{0}};
  const auto joined = [](test::Bytes a, const test::Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  test::Bytes out(raw.size()), twice(2 * raw.size());
  decode_zstd(one, column.filter, out);
  CHECK_THROWS_AS(decode_zstd(joined(one, one), column.filter, twice), Error);
  CHECK_THROWS_AS(decode_zstd(joined(nothing, one), column.filter, out), Error);
  CHECK_THROWS_AS(decode_zstd(joined(one, nothing), column.filter, out), Error);
  CHECK_THROWS_AS(decode_zstd(joined(one, {std::byte{0}}), column.filter, out), Error);
}

TEST_CASE("a zstd column that is too short for its records is refused before room is made") {
  Head head;
  head.chunk_capacity = kMaxChunkRecords;
  head.channels = {{"value", Type::f32, 1}};
  const auto decode = [&](std::uint64_t stored) {
    Frame frame;
    frame.prefix = {{}, kChunkType, 1, 0, 64 * kPage, 2};
    frame.directory =
        encode_chunk({0, 0, 1u << 20, 0, {{0, Codec::zstd, Filter::shuffle4, 0, 128, stored}}});
    return decode_chunk(frame, head);
  };
  // 4 MiB: 32 blocks of 128 KiB, of 4 bytes each at least.
  CHECK_THROWS_AS(decode(127), Error);
  CHECK(decode(128).columns.at(0).stored == 128);
  const test::Bytes zeros(std::size_t{4} << 20);
  Buffer storage;
  CHECK(encode_column(Codec::zstd, zeros, storage).bytes.size() > 128);
}
