#include "render/loop/shade_rate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace psf::render {
namespace {

constexpr double kGoldenRatio = 0.6180339887498949;

// Squared length of the shortest vector of the lattice x + b y = 0 (mod k).
std::uint64_t shortest_sq(std::uint64_t k, std::uint64_t b) {
  std::uint64_t best = k * k;
  for (std::uint64_t y = 1; y * y < best; ++y) {
    const std::uint64_t x = (k - b * y % k) % k;
    const std::uint64_t nearest = std::min(x, k - x);
    best = std::min(best, nearest * nearest + y * y);
  }
  return best;
}

// Number coprime to k nearest to the golden section of it.
std::uint32_t golden_step(std::uint32_t k) {
  const auto middle = static_cast<std::uint32_t>(std::lround(k * kGoldenRatio));
  for (std::uint32_t offset = 0; offset < k; ++offset) {
    if (middle >= offset && std::gcd(middle - offset, k) == 1) return middle - offset;
    if (std::gcd(middle + offset, k) == 1) return (middle + offset) % k;
  }
  return 1;
}

}  // namespace

ShadeRate::ShadeRate(std::uint32_t k) : k_(k), b_(1), c_(golden_step(k)) {
  assert(k >= 1 && k <= kMostShadeRate);
  constexpr std::uint32_t kTrials = 512;  // enough to come near the best of large rates
  std::uint64_t best = 0;
  for (std::uint32_t b = 1; b < std::min(k, kTrials); ++b) {
    const std::uint64_t distance_sq = shortest_sq(k, b);
    if (distance_sq > best) {
      best = distance_sq;
      b_ = b;
    }
  }
}

}  // namespace psf::render
