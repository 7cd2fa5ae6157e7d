// One camera's picture as sums: the mean over the paths of each pixel [pixel].
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace psf::film {

// Sums are in double, so that the mean of millions of paths is exact to float. Add a pixel's paths
// from one thread and in path order; then the picture has the same bytes for any number of threads.
class Film {
 public:
  Film(std::size_t width, std::size_t height)
      : width_(width), height_(height), sum_(3 * width * height), count_(width * height) {}

  // `pixel`: y * width + x, row 0 at the top.
  void add(std::uint32_t pixel, const Rgb& radiance) {
    sum_[3 * std::size_t{pixel}] += radiance.x;
    sum_[3 * std::size_t{pixel} + 1] += radiance.y;
    sum_[3 * std::size_t{pixel} + 2] += radiance.z;
    ++count_[pixel];
  }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  // The means, (height, width, 3); 0 where a pixel has no path.
  [[nodiscard]] std::vector<float> mean() const;
  // The means of one colour component, 0, 1 or 2, (height, width).
  [[nodiscard]] std::vector<float> mean(std::size_t component) const;
  // The means, (height, width, 3). A pixel without path gets the mean of all paths in the smallest
  // square around it of 2 x 2, 4 x 4, 8 x 8, ... pixels, aligned to its size, that has any path.
  [[nodiscard]] std::vector<float> filled_mean() const;
  [[nodiscard]] bool has_path(std::size_t pixel) const { return count_[pixel] > 0; }
  [[nodiscard]] bool has_path_everywhere() const;

 private:
  std::size_t width_, height_;
  std::vector<double> sum_;
  std::vector<std::uint64_t> count_;
};

}  // namespace psf::film
