// The quantisations of the format: unit vectors as octahedral 2 x 16 bits, and half floats.
#pragma once

#include <cstdint>
#include <span>

namespace psf::formats {

// Convert unit vectors (count, 3) to codes (count, 2) and back, with an error of at most 0.004
// degrees. The zero vector stays zero, a vector that is not finite comes back as NaN, and any other
// length is lost. The formula is in README.md, "Octahedral".
void encode_octahedral(std::span<const float> vectors, std::span<std::uint16_t> codes);
void decode_octahedral(std::span<const std::uint16_t> codes, std::span<float> vectors);

// Convert to IEEE 754 binary16, rounded to nearest even, and back. Values that are too large become
// infinity.
void encode_half(std::span<const float> values, std::span<std::uint16_t> halves);
void decode_half(std::span<const std::uint16_t> halves, std::span<float> values);

}  // namespace psf::formats
