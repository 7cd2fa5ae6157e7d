// Numbers that look random, from numbers: the same on every machine and for any number of threads.
#pragma once

#include <cstdint>

namespace psf::filter {

// The finalizer of SplitMix64 (Steele, Lea, Flood 2014) behind its step: a bijection of 64 bits in
// which every bit of the argument changes each bit of the result half of the time.
[[nodiscard]] inline std::uint64_t scramble(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

// The upper 32 bits, in [0, 1).
[[nodiscard]] inline double to_unit(std::uint64_t bits) {
  return static_cast<double>(bits >> 32) * 0x1p-32;
}

}  // namespace psf::filter
