#include "search/curve_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace psf::search {
namespace {

constexpr int kBits =
    10;  // an axis: cells of a thousandth of the bounds are fine enough for a cache

// Puts two zero bits between the lowest kBits bits.
std::uint32_t spread(std::uint32_t v) {
  v = (v | (v << 16)) & 0x030000FFu;
  v = (v | (v << 8)) & 0x0300F00Fu;
  v = (v | (v << 4)) & 0x030C30C3u;
  v = (v | (v << 2)) & 0x09249249u;
  return v;
}

}  // namespace

std::vector<std::uint32_t> curve_order(std::span<const Vec3> points,
                                       std::span<const std::uint32_t> chosen) {
  if (chosen.empty()) return {};
  Vec3 low = points[chosen[0]], high = low;
  for (const std::uint32_t k : chosen) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], points[k][axis]);
      high[axis] = std::max(high[axis], points[k][axis]);
    }
  }
  // In double: the extent of finite floats may be no finite float.
  constexpr double kCells = 1 << kBits;
  std::array<double, 3> scale{};
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = double{high[axis]} - double{low[axis]};
    scale[static_cast<std::size_t>(axis)] = extent > 0 ? kCells / extent : 0;
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keyed;  // key on the curve, number
  keyed.reserve(chosen.size());
  for (const std::uint32_t k : chosen) {
    std::uint32_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell =
          (double{points[k][axis]} - double{low[axis]}) * scale[static_cast<std::size_t>(axis)];
      key |= spread(static_cast<std::uint32_t>(std::min(cell, kCells - 1))) << axis;
    }
    keyed.emplace_back(key, k);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> order(keyed.size());
  std::transform(keyed.begin(), keyed.end(), order.begin(),
                 [](const auto& entry) { return entry.second; });
  return order;
}

}  // namespace psf::search
