// Sums over tiles of a picture, so that means have standard errors although neighbouring pixels
// share neighbours: the noise of different tiles is taken for independent.
#pragma once

#include <cstddef>
#include <vector>

namespace psf::study {

class Tiles {
 public:
  Tiles() = default;
  // A picture of so many pixels.
  Tiles(std::size_t width, std::size_t height);

  void add(std::size_t pixel, double value) {
    values_[pixel / width_ / kTile * columns_ + pixel % width_ / kTile] += value;
    sum_ += value;
  }
  // Adds the sums of another picture of the same size.
  void add(const Tiles& others);

  [[nodiscard]] double sum() const { return sum_; }
  [[nodiscard]] double standard_error() const { return standard_error_beyond(1, Tiles()); }
  // The standard error of `factor` times this sum minus that of `others`, which may be empty;
  // infinite for one tile.
  [[nodiscard]] double standard_error_beyond(double factor, const Tiles& others) const;

 private:
  static constexpr std::size_t kTile = 8;  // pixels

  std::size_t width_ = 1, columns_ = 1;
  std::vector<double> values_;
  double sum_ = 0;
};

}  // namespace psf::study
