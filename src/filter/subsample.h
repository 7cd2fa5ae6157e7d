// The choice of --sources 1/K: which records keep their contribution.
#pragma once

#include <cstdint>

namespace psf::filter {

// A rank-1 pattern: the fraction of x a + y b + p g, with (a, b) the powers of the plastic number's
// inverse and g that of the golden ratio, is below 1/K. Well spread over the picture in a pass p,
// each pixel is chosen once in about K passes, and what is chosen does not depend on the sampler's
// dimensions. Integers: exact everywhere.
[[nodiscard]] inline bool is_chosen(std::uint32_t x, std::uint32_t y, std::uint64_t pass,
                                    std::uint32_t k) {
  constexpr std::uint32_t kA = 0xC13FA9A9u, kB = 0x91E10DA5u, kG = 0x9E3779B9u;  // times 2^32
  const std::uint32_t fraction = x * kA + y * kB + static_cast<std::uint32_t>(pass) * kG;
  return std::uint64_t{fraction} * k < (std::uint64_t{1} << 32);
}

}  // namespace psf::filter
