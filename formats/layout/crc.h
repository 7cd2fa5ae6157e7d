// CRC-32 with zlib's polynomial.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace psf::formats {

// The checksum of bytes that follow others; `before` is the checksum of those, 0 at the start.
[[nodiscard]] std::uint32_t crc32(std::uint32_t before, std::span<const std::byte> bytes);
[[nodiscard]] inline std::uint32_t crc32(std::span<const std::byte> bytes) {
  return crc32(0, bytes);
}

// Whether a computed checksum equals the stored one. Checksums are compared only here. A build for
// fuzzing (PSF_FUZZ_WITHOUT_CHECKSUMS) accepts every checksum, to test the code behind the checks.
[[nodiscard]] constexpr bool crc_matches([[maybe_unused]] std::uint32_t computed,
                                         [[maybe_unused]] std::uint32_t stored) {
#ifdef PSF_FUZZ_WITHOUT_CHECKSUMS
  return true;
#else
  return computed == stored;
#endif
}

}  // namespace psf::formats
