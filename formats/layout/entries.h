// The entries of the directories: columns of a chunk, chunks and passes of a file.
#pragma once

#include <cstdint>

namespace psf::formats {

enum class Codec : std::uint8_t { raw = 0, zstd = 1 };

enum class Filter : std::uint8_t { none = 0, shuffle4 = 1 };

struct Pass {
  std::uint64_t first = 0;  // number of the first record
  std::uint64_t count = 0;
};

// The place of a chunk, as in the index of the file.
struct ChunkEntry {
  std::uint64_t offset = 0, length = 0;  // place and size of its frame, bytes
  std::uint64_t first = 0;               // number of the first record
  std::uint32_t count = 0;
  std::uint32_t pass = 0;
  bool operator==(const ChunkEntry&) const = default;
};

// One channel of one chunk, as stored.
struct Column {
  std::uint16_t channel = 0;
  Codec codec = Codec::raw;
  Filter filter{};
  std::uint32_t crc = 0;     // checksum of the stored bytes
  std::uint64_t offset = 0;  // place in the frame
  std::uint64_t stored = 0;  // number of stored bytes
};

}  // namespace psf::formats
