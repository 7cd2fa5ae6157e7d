// The declared quantisations: unit vectors as octahedral 2 x 16 bits, and half floats.
#pragma once

#include <cstdint>
#include <span>

namespace psf::formats {

// Unit vectors (count, 3) to codes (count, 2) and back; worst error 0.004 degrees. The zero vector
// stays zero, a vector that is not finite comes back as NaN; any other length is lost. Formula:
// README.md, "Octahedral".
void encode_octahedral(std::span<const float> vectors, std::span<std::uint16_t> codes);
void decode_octahedral(std::span<const std::uint16_t> codes, std::span<float> vectors);

// IEEE 754 binary16, rounded to nearest even; what is too large becomes infinity.
void encode_half(std::span<const float> values, std::span<std::uint16_t> halves);
void decode_half(std::span<const std::uint16_t> halves, std::span<float> values);

}  // namespace psf::formats
