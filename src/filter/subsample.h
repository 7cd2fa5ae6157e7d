// The pattern of --sources 1/K, which chooses the records that keep their contribution.
#pragma once

#include <cstdint>

namespace psf::filter {

// The fraction of x a + y b + pass g, times 2^32: a rank-1 pattern, in which a record is chosen
// where the fraction is below 1/K. a and b are the first and second power of 1 over the plastic
// number, and g is 1 over the golden ratio. The chosen pixels of a pass are well spread over the
// picture, each pixel is chosen once in about K passes, and the choice does not depend on the
// sampler's dimensions. Integers make it exact on every machine.
[[nodiscard]] inline std::uint32_t fraction_of(std::uint32_t x, std::uint32_t y,
                                               std::uint64_t pass) {
  constexpr std::uint32_t kA = 0xC13FA9A9u, kB = 0x91E10DA5u, kG = 0x9E3779B9u;  // times 2^32
  return x * kA + y * kB + static_cast<std::uint32_t>(pass) * kG;
}
[[nodiscard]] inline bool is_chosen(std::uint32_t x, std::uint32_t y, std::uint64_t pass,
                                    std::uint32_t k) {
  return std::uint64_t{fraction_of(x, y, pass)} * k < (std::uint64_t{1} << 32);
}
// Whether the same pattern chooses a record where any `share` in [0, 1] is chosen.
[[nodiscard]] inline bool is_chosen(std::uint32_t x, std::uint32_t y, std::uint64_t pass,
                                    double share) {
  return static_cast<double>(fraction_of(x, y, pass)) < 0x1p32 * share;
}

}  // namespace psf::filter
