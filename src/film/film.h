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
  // `parts`: how many colours each path adds.
  Film(std::size_t width, std::size_t height, std::size_t parts = 1)
      : width_(width), height_(height), sum_(3 * parts * width * height), count_(width * height) {}

  // Adds a path with the colour of its first part. `pixel`: y * width + x, row 0 at the top.
  void add(std::uint32_t pixel, const Rgb& radiance) {
    add_part(0, pixel, radiance);
    count(pixel);
  }
  // Counts a path that add() does not.
  void count(std::uint32_t pixel) { ++count_[pixel]; }
  // Adds another part of a path.
  void add_part(std::size_t part, std::uint32_t pixel, const Rgb& radiance) {
    double* sum = &sum_[3 * (part * count_.size() + pixel)];
    sum[0] += radiance.x;
    sum[1] += radiance.y;
    sum[2] += radiance.z;
  }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  // The means of the first part, (height, width, 3); 0 where a pixel has no path.
  [[nodiscard]] std::vector<float> mean() const { return mean_of_part(0); }
  // The means of one component, (height, width): colour c of part p is 3 p + c.
  [[nodiscard]] std::vector<float> mean(std::size_t component) const;
  // The means of a part, (height, width, 3). A pixel without path gets the mean of all paths in the
  // smallest square around it of 2 x 2, 4 x 4, 8 x 8, ... pixels, aligned to its size, that has any
  // path.
  [[nodiscard]] std::vector<float> filled_mean(std::size_t part = 0) const;
  [[nodiscard]] bool has_path(std::size_t pixel) const { return count_[pixel] > 0; }
  [[nodiscard]] bool has_path_everywhere() const;

 private:
  [[nodiscard]] std::vector<float> mean_of_part(std::size_t part) const;

  std::size_t width_, height_;
  std::vector<double> sum_;  // (parts, height, width, 3)
  std::vector<std::uint64_t> count_;
};

}  // namespace psf::film
