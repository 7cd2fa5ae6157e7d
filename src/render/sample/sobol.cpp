// Builds the generator matrices of the Sobol' sequence from its polynomials and initial numbers.
#include "render/sample/sobol.h"

#include <array>
#include <bit>

#include "render/sample/sampler_hash.h"

namespace psf::render {
namespace {

// Column j of a dimension's matrix as a 64-bit binary fraction (bit 63 weighs 1/2), by the
// recurrence of P. Bratley and B. L. Fox, "Algorithm 659", 1988. 64 bits, because columns past the
// 32nd begin below the 32 bits that are kept only after the recurrence has passed them on.
std::array<std::uint64_t, kSobolIndexBits> columns(std::uint32_t dimension) {
  std::array<std::uint64_t, kSobolIndexBits> column{};
  if (dimension == 0) {
    for (std::size_t j = 0; j < column.size(); ++j) column[j] = std::uint64_t{1} << (63 - j);
    return column;
  }
  const SobolNumbers& numbers = kSobolNumbers[dimension - 1];
  const auto degree = static_cast<std::size_t>(std::bit_width(numbers.polynomial) - 1);
  for (std::size_t j = 0; j < column.size(); ++j) {
    if (j < degree) {
      column[j] = std::uint64_t{numbers.m[j]} << (63 - j);
      continue;
    }
    column[j] = column[j - degree] ^ (column[j - degree] >> degree);
    for (std::size_t k = 1; k < degree; ++k) {
      if ((numbers.polynomial >> (degree - k) & 1) != 0) column[j] ^= column[j - k];
    }
  }
  return column;
}

SobolTables build() {
  SobolTables tables{};
  for (std::uint32_t d = 0; d < kSobolDimensions; ++d) {
    const auto column = columns(d);
    for (std::size_t nibble = 0; nibble < SobolTables::kNibbles; ++nibble) {
      for (std::size_t value = 0; value < 16; ++value) {
        std::uint32_t sum = 0;
        for (std::size_t bit = 0; bit < 4; ++bit) {
          if ((value >> bit & 1) != 0) sum ^= high(column[4 * nibble + bit]);
        }
        tables.sums[d][nibble][value] = reverse_bits(sum);
      }
    }
  }
  return tables;
}

}  // namespace

const SobolTables kSobolTables = build();

}  // namespace psf::render
