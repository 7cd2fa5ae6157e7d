// How a column is stored: raw, or zstd behind a shuffle that puts like bytes of 4-byte words
// together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "formats/writer.h"

namespace psf::formats {

enum class Filter : std::uint8_t { none = 0, shuffle4 = 1 };

// Memory that is not cleared, grows as needed and is used again.
class Buffer {
 public:
  // Contents are not kept.
  [[nodiscard]] std::span<std::byte> get(std::size_t size);

 private:
  std::unique_ptr<std::byte[]> data_;
  std::size_t capacity_ = 0;
};

struct EncodedColumn {
  Codec codec = Codec::raw;
  Filter filter = Filter::none;
  std::uint32_t crc = 0;             // of `bytes`
  std::span<const std::byte> bytes;  // in `raw` or in `storage`
};

// Raw where zstd does not make it smaller. Thread-safe.
[[nodiscard]] EncodedColumn encode_column(Codec wanted, std::span<const std::byte> raw,
                                          Buffer& storage);

// Fills `out` exactly from a zstd column; throws Error{bad_input} where it does not decode to that
// many bytes. Thread-safe.
void decode_zstd(std::span<const std::byte> stored, Filter filter, std::span<std::byte> out);

// Byte k of all 4-byte words, for k = 0 to 3, then the bytes that fill no word. Sizes are equal.
void shuffle4(std::span<const std::byte> in, std::span<std::byte> out);
void unshuffle4(std::span<const std::byte> in, std::span<std::byte> out);

}  // namespace psf::formats
