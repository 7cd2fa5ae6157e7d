#include "study/tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace psf::study {

Tiles::Tiles(std::size_t width, std::size_t height)
    : width_(width),
      columns_((width + kTile - 1) / kTile),
      values_(columns_ * ((height + kTile - 1) / kTile)) {}

void Tiles::add(const Tiles& others) {
  for (std::size_t k = 0; k < values_.size(); ++k) values_[k] += others.values_[k];
  sum_ += others.sum_;
}

double Tiles::standard_error_beyond(double factor, const Tiles& others) const {
  const auto count = static_cast<double>(values_.size());
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < values_.size(); ++k) {
    const double value = factor * values_[k] - (others.values_.empty() ? 0 : others.values_[k]);
    sum += value;
    squares += value * value;
  }
  if (count < 2) return std::numeric_limits<double>::infinity();
  const double variance = std::max(0.0, (squares - sum * sum / count) / (count - 1));
  return std::sqrt(variance * count);
}

}  // namespace psf::study
