// The choice of --sources 1/K: which records keep their contribution, and which of those without
// one count.
#pragma once

#include <cstdint>

namespace psf::filter {

// A rank-1 pattern: the fraction of x a + y b + p g, with (a, b) the powers of the plastic number's
// inverse and g that of the golden ratio, is below 1/K. Well spread over the picture in a pass p,
// each pixel is chosen once in about K passes, and what is chosen does not depend on the sampler's
// dimensions. Integers: exact everywhere.
[[nodiscard]] inline std::uint32_t fraction_of(std::uint32_t x, std::uint32_t y,
                                               std::uint64_t pass) {
  constexpr std::uint32_t kA = 0xC13FA9A9u, kB = 0x91E10DA5u, kG = 0x9E3779B9u;  // times 2^32
  return x * kA + y * kB + static_cast<std::uint32_t>(pass) * kG;
}
[[nodiscard]] inline bool is_chosen(std::uint32_t x, std::uint32_t y, std::uint64_t pass,
                                    std::uint32_t k) {
  return std::uint64_t{fraction_of(x, y, pass)} * k < (std::uint64_t{1} << 32);
}
// The same pattern for any share in [0, 1].
[[nodiscard]] inline bool is_chosen(std::uint32_t x, std::uint32_t y, std::uint64_t pass,
                                    double share) {
  return static_cast<double>(fraction_of(x, y, pass)) < 0x1p32 * share;
}

}  // namespace psf::filter
