// Points of the Halton sequence, its digits scrambled by a hash.
#include "render/sample/halton.h"

#include <algorithm>
#include <array>

#include "render/sample/sampler_hash.h"

namespace psf::render {
namespace {

__extension__ using Wide = unsigned __int128;

struct PrimeBase {
  std::uint32_t value;
  std::uint32_t digits;      // as many as make steps below 2^-24, the precision of the result
  std::uint64_t reciprocal;  // ceil(2^64 / value): exact division of numbers below 2^54
};

constexpr std::array<PrimeBase, kHaltonDimensions> make_bases() {
  std::array<PrimeBase, kHaltonDimensions> bases{};
  std::size_t count = 0;
  for (std::uint32_t n = 2; count < bases.size(); ++n) {
    const bool prime = std::none_of(bases.begin(), bases.begin() + count,
                                    [n](const PrimeBase& base) { return n % base.value == 0; });
    if (!prime) continue;
    std::uint32_t digits = 0;
    for (double step = 1; step > 0x1p-24; step /= n) ++digits;
    bases[count++] = {n, digits, ~std::uint64_t{0} / n + 1};
  }
  return bases;
}
constexpr auto kBases = make_bases();

std::uint64_t divide(std::uint64_t n, const PrimeBase& base) {
  return static_cast<std::uint64_t>((Wide{n} * base.reciprocal) >> 64);
}

}  // namespace

std::uint32_t halton_base(std::uint32_t dimension) {
  return kBases[dimension].value;
}

float halton(std::uint64_t index, std::uint32_t dimension, std::uint64_t key) {
  const PrimeBase& base = kBases[dimension];
  std::uint64_t value = 0;
  std::uint64_t scale = 1;
  for (std::uint32_t k = 0; k < base.digits; ++k) {
    const std::uint64_t rest = divide(index, base);
    const std::uint64_t digit = index - rest * base.value;
    const std::uint64_t hash = mix(key);
    const std::uint64_t a = 1 + ((hash & 0xffffffffu) * (base.value - 1) >> 32);
    const std::uint64_t c = (hash >> 32) * base.value >> 32;
    const std::uint64_t image = a * digit + c;
    value = value * base.value + (image - divide(image, base) * base.value);
    scale *= base.value;
    key = (key ^ (digit + 1)) * kGolden;
    index = rest;
  }
  // Truncated to the 24 bits of a float, so that rounding never gives 1.
  const auto bits =
      static_cast<std::uint64_t>(static_cast<double>(value) / static_cast<double>(scale) * 0x1p24);
  return static_cast<float>(std::min<std::uint64_t>(bits, 0xffffff)) * 0x1p-24f;
}

}  // namespace psf::render
