// Points of the Halton sequence, with digits scrambled by a hash.
#pragma once

#include <cstdint>

namespace psf::render {

constexpr std::uint32_t kHaltonDimensions = 128;  // bases 2, 3, 5, ..., 719

// The base of a dimension: 2, 3, 5, ... for dimension = 0, 1, 2, ... < kHaltonDimensions.
[[nodiscard]] std::uint32_t halton_base(std::uint32_t dimension);

// The radical inverse of `index` in the dimension's base b, in [0, 1), with nested scrambling: each
// digit d becomes (a d + c) mod b, with a in [1, b) and c in [0, b) from a hash of `key` and the
// preceding digits. Two different digits behind the same digits go to any two different digits with
// equal probability. This is all that the variance of Owen's scrambling with full permutations
// depends on (J. Matousek, "On the L2-discrepancy for anchored boxes", 1998). dimension <
// kHaltonDimensions, index < 2^48.
[[nodiscard]] float halton(std::uint64_t index, std::uint32_t dimension, std::uint64_t key);

}  // namespace psf::render
