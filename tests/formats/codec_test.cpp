// Checksums, shuffle and zstd against their definitions.
#include "formats/codec.h"

#include <random>

#include "catch.h"
#include "file_bytes.h"
#include "formats/crc.h"
#include "formats/error.h"

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
