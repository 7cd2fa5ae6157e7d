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

// Whether what was computed is what the file says. The one place where checksums are tested: a
// build for fuzzing (PSF_FUZZ_WITHOUT_CHECKSUMS) takes every one for right, to get behind them.
[[nodiscard]] constexpr bool crc_matches([[maybe_unused]] std::uint32_t computed,
                                         [[maybe_unused]] std::uint32_t stored) {
#ifdef PSF_FUZZ_WITHOUT_CHECKSUMS
  return true;
#else
  return computed == stored;
#endif
}

}  // namespace psf::formats
