// CRC-32 with zlib's polynomial.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace psf::formats {

// Continues from the checksum of the bytes before; 0 starts.
[[nodiscard]] std::uint32_t crc32(std::uint32_t before, std::span<const std::byte> bytes);
[[nodiscard]] inline std::uint32_t crc32(std::span<const std::byte> bytes) {
  return crc32(0, bytes);
}

}  // namespace psf::formats
