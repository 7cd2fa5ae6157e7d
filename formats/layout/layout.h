// The numbers of the path-vertex buffer's layout and its limits, as README.md of this folder gives
// them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace psf::formats {

// Columns are moved between memory and file as they are.
static_assert(std::endian::native == std::endian::little,
              "path-vertex buffers are little-endian; big-endian hosts are not supported");

constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'P', 'V', 'B', 0x0D, 0x0A, 0x1A, 0x01};
constexpr std::uint16_t kMajor = 1;
constexpr std::uint16_t kMinor = 1;  // of a file with tables; others are of version 1.0
constexpr std::uint32_t kKnownRequiredFeatures = 0;
constexpr std::uint32_t kTablesFeature = 2;  // optional

constexpr std::size_t kPage = 4096;     // frames start at multiples of it and are padded to them
constexpr std::size_t kPrefix = 64;     // size of a frame's prefix
constexpr std::size_t kAlignment = 64;  // alignment of columns and sections in a frame

// The number of a frame type: four characters, read as a little-endian number.
constexpr std::uint32_t frame_type(const char (&name)[5]) {
  std::uint32_t value = 0;
  for (int k = 3; k >= 0; --k) value = value << 8 | static_cast<std::uint8_t>(name[k]);
  return value;
}
constexpr std::uint32_t kHeadType = frame_type("HEAD");
constexpr std::uint32_t kSlotType = frame_type("SLOT");
constexpr std::uint32_t kChunkType = frame_type("CHNK");
constexpr std::uint32_t kTableChunkType = frame_type("TCHK");
constexpr std::uint32_t kCommitType = frame_type("CMIT");
constexpr std::uint32_t kRequiredFrame =
    1;  // flag: a reader that does not know the type must refuse the file

constexpr std::size_t kHeadFixed = 64, kChannelEntry = 64, kChannelName = 56;
constexpr std::size_t kSlotRecord = 32, kSlotFirst = 1024, kSlotSecond = 2048;
constexpr std::size_t kChunkFixed = 32, kColumnEntry = 24;
constexpr std::size_t kCommitFixed = 160, kIndexEntry = 32, kTableTotals = 32;
constexpr std::uint32_t kClosed = 1;  // flag of a commit

// These decide which earlier entries a commit repeats: see README.md, "The index".
constexpr std::uint64_t kIndexStep = 64, kIndexLeap = 4096;

constexpr std::size_t kMaxChannels = 256;  // of the paths, and of each table
constexpr std::size_t kMaxTables = 16;
constexpr std::size_t kMaxComponents = 16;
constexpr std::uint32_t kMaxChunkRecords = 1u << 24;
constexpr std::uint64_t kMaxChunkBytes = 1ull << 30;  // decoded, all columns together
constexpr std::size_t kMaxDirectory = std::size_t{16} << 20;
constexpr std::size_t kMaxMetadata = std::size_t{1} << 20;
constexpr std::size_t kMaxResumeState = std::size_t{64} << 10;

constexpr std::uint64_t align_up(std::uint64_t value, std::uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

}  // namespace psf::formats
