#include "filter/engine/ring_table.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace psf::filter::engine {
namespace {

// Roundings of f_i^2, its inverse, their product with d_sq, of r_i and of its square: seven, each
// 2^-24 at most.
constexpr double kMargin = 1.0 / (1 << 20);

std::int32_t place_of(double t) {
  return std::bit_cast<std::int32_t>(static_cast<float>(t)) >> RingTable::kShift;
}
double start_of(std::int32_t place) {
  return double{std::bit_cast<float>(place << RingTable::kShift)};
}

}  // namespace

RingTable::RingTable(std::span<const double> scales) : scales_(scales.begin(), scales.end()) {
  assert(!scales.empty() && scales.back() > 0);
  const auto positive = std::upper_bound(scales_.begin(), scales_.end(), 0.0);
  first_ = place_of(*positive * *positive * (1 - kMargin)) - 1;
  const std::int32_t last = place_of(scales_.back() * scales_.back() * (1 - kMargin));
  std::vector<double> squares;
  for (const double scale : scales_) squares.push_back(scale * scale);
  table_.resize(static_cast<std::size_t>(last - first_) + 1);
  auto ring = positive - scales_.begin();  // the first whose square is not below the place at hand
  for (std::int32_t place = first_; place <= last; ++place) {
    const double low = start_of(place) * (1 - kMargin), high = start_of(place + 1) * (1 + kMargin);
    while (squares[static_cast<std::size_t>(ring)] < low) ++ring;
    const auto within =
        std::upper_bound(squares.begin() + ring, squares.end(), high) - squares.begin() - ring;
    table_[static_cast<std::size_t>(place - first_)] =
        within > 1 ? kOpen : static_cast<std::int32_t>(2 * ring + within);
  }
}

}  // namespace psf::filter::engine
