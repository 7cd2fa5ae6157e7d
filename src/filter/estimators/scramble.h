// A hash of numbers to numbers that look random; the same on every machine.
#pragma once

#include <cstdint>

namespace psf::filter {

// One step and the finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64 bits in
// which every bit of the argument changes each bit of the result half of the time.
[[nodiscard]] inline std::uint64_t scramble(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

// The upper 32 bits over 2^32, in [0, 1).
[[nodiscard]] inline double to_unit(std::uint64_t bits) {
  return static_cast<double>(bits >> 32) * 0x1p-32;
}

}  // namespace psf::filter
