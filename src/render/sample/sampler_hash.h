// The integer hashes behind the samplers: mixing of keys, and Owen scrambling in base 2 as a hash.
#pragma once

#include <cstdint>

namespace psf::render {

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;  // 2^64 / golden ratio, odd

// A bijection whose every output bit depends on every input bit (Stafford's variant 13).
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

[[nodiscard]] constexpr std::uint32_t low(std::uint64_t x) {
  return static_cast<std::uint32_t>(x);
}
[[nodiscard]] constexpr std::uint32_t high(std::uint64_t x) {
  return static_cast<std::uint32_t>(x >> 32);
}

[[nodiscard]] constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

// Nested uniform scrambling of a fraction whose bits are reversed, so that bit 0 weighs 1/2. Each
// bit is flipped by a hash of the bits below it, since sums and products carry upward only. After
// S. Laine
// and T. Karras 2011, B. Burley 2020 ("Practical hash-based Owen scrambling"), with the constants
// of N. Vegdahl 2021, which come closer to true Owen scrambling.
[[nodiscard]] constexpr std::uint32_t owen_scramble_reversed(std::uint32_t x, std::uint32_t key) {
  x ^= x * 0x3d20adeau;
  x += key;
  x *= (key >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// The upper 24 bits as a float in [0, 1), exactly; never 1.
[[nodiscard]] constexpr float to_unit(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

}  // namespace psf::render
