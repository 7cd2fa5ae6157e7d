// Encodes columns: raw, or by zstd after a shuffle that puts equal bytes of 4-byte words together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "formats/layout/entries.h"

namespace psf::formats {

// Memory that is not cleared, grows as needed and is reused.
class Buffer {
 public:
  // Returns `size` bytes; earlier contents are lost.
  [[nodiscard]] std::span<std::byte> get(std::size_t size);

 private:
  std::unique_ptr<std::byte[]> data_;
  std::size_t capacity_ = 0;
};

struct EncodedColumn {
  Codec codec = Codec::raw;
  Filter filter = Filter::none;
  std::uint32_t crc = 0;             // checksum of `bytes`
  std::span<const std::byte> bytes;  // lie in `raw` or `storage` of encode_column()
};

// Encodes a column; it stays raw where zstd does not make it smaller. Thread-safe.
[[nodiscard]] EncodedColumn encode_column(Codec wanted, std::span<const std::byte> raw,
                                          Buffer& storage);

// Decodes a zstd column to `out`. Throws Error{bad_input} where it does not decode to exactly the
// size of `out`. Thread-safe.
void decode_zstd(std::span<const std::byte> stored, Filter filter, std::span<std::byte> out);
// Whether a zstd column decodes to `size` bytes that are all 0, of any filter. Throws what
// decode_zstd() throws.
[[nodiscard]] bool decodes_to_zeros(std::span<const std::byte> stored, std::size_t size);

// Writes byte k of all 4-byte words, for k = 0 to 3, and then the bytes left over. `in` and `out`
// have the same size.
void shuffle4(std::span<const std::byte> in, std::span<std::byte> out);
void unshuffle4(std::span<const std::byte> in, std::span<std::byte> out);

}  // namespace psf::formats
