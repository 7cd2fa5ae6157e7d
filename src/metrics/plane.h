// One channel of a picture, and separable filters over it.
#pragma once

#include <cstddef>
#include <vector>

#include "core/parallel.h"

namespace psf::metrics {

// Rows are padded to whole chunks, so that the compiler knows the length of inner loops. The values
// in the padding mean nothing.
class Plane {
 public:
  static constexpr std::size_t kChunk = 16;

  Plane() = default;
  Plane(std::size_t width, std::size_t height)
      : width_(width),
        height_(height),
        stride_((width + kChunk - 1) / kChunk * kChunk),
        values_(stride_ * height) {}

  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] float* row(std::size_t y) { return values_.data() + y * stride_; }
  [[nodiscard]] const float* row(std::size_t y) const { return values_.data() + y * stride_; }

 private:
  std::size_t width_ = 0, height_ = 0, stride_ = 0;
  std::vector<float> values_;
};

// Calls body(y, x) for every pixel, rows in parallel.
template <class Body>
void for_pixels(const Plane& plane, const Body& body) {
  constexpr std::size_t kRows = 16;
  core::parallel_for(plane.height(), kRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t x = 0; x < plane.width(); ++x) body(y, x);
    }
  });
}

// 2 radius + 1 weights; weight i belongs to the pixel at distance i - radius.
using Kernel = std::vector<float>;

// Replaces each value by the weighted sum along its row, or its column. Beyond the border the last
// pixel is repeated.
[[nodiscard]] Plane along_rows(const Plane& plane, const Kernel& kernel);
[[nodiscard]] Plane along_columns(const Plane& plane, const Kernel& kernel);

}  // namespace psf::metrics
