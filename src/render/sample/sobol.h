// Points of the Sobol' sequence as integers: a (t, s)-sequence in base 2, t = 0 for dimensions
// 0, 1.
#pragma once

#include <cstddef>
#include <cstdint>

namespace psf::render {

constexpr std::uint32_t kSobolDimensions = 128;
constexpr int kSobolIndexBits = 48;  // bits of the index above these are ignored

// The numbers that define dimension d + 1, at index d of kSobolNumbers; dimension 0 is the van der
// Corput sequence and needs none. Bit k of `polynomial` is the coefficient of z^k of a primitive
// polynomial; `m` holds the initial odd numbers, as many as its degree.
struct SobolNumbers {
  std::uint16_t polynomial;
  std::uint16_t m[10];
};
extern const SobolNumbers kSobolNumbers[kSobolDimensions - 1];

// The generator matrices, read four index bits at a time: [dimension][nibble of the index][its
// value].
struct SobolTables {
  static constexpr int kNibbles = kSobolIndexBits / 4;
  std::uint32_t sums[kSobolDimensions][kNibbles][16];
};
extern const SobolTables kSobolTables;

// The coordinate of point `index`, with reversed bits (bit 0 weighs 1/2), as scrambling needs it.
// dimension < kSobolDimensions, index < 2^kSobolIndexBits.
[[nodiscard]] inline std::uint32_t sobol_reversed(std::uint64_t index, std::uint32_t dimension) {
  const auto* row = kSobolTables.sums[dimension];
  std::uint32_t bits = 0;
  for (; index != 0; index >>= 4, ++row) bits ^= (*row)[index & 15];
  return bits;
}

// The same for dimension 1, without a table. The generator matrix is Pascal's triangle modulo 2,
// where entry (i, j) is 1 if the bits of i are among those of j. It is a Kronecker power of [1 1; 0
// 1], which is applied bit by bit.
[[nodiscard]] constexpr std::uint32_t sobol_reversed_1(std::uint32_t index) {
  index ^= (index >> 16) & 0x0000ffffu;
  index ^= (index >> 8) & 0x00ff00ffu;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 1) & 0x55555555u;
  return index;
}

}  // namespace psf::render
