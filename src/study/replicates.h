// Bias and variance of a picture, estimated from independent replicates of it.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::study {

struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

// The parts of relMSE: squares over r^2 + epsilon, where r is the reference, as means over pixels
// and channels. The expected values satisfy error = bias_sq + variance. `bias_sq` is estimated
// without bias, so it may be below 0 where it is small; it includes the error of the reference.
struct ErrorParts {
  double error = std::numeric_limits<double>::quiet_NaN();  // mean error of a single replicate
  // NaN with fewer than two replicates. The 95% intervals are by the jackknife, and NaN with fewer
  // than three.
  double bias_sq = std::numeric_limits<double>::quiet_NaN();
  double variance = std::numeric_limits<double>::quiet_NaN();
  Interval bias_sq_interval, variance_interval;
};

// A part of the picture: pixels [x, x + width) x [y, y + height).
struct Rectangle {
  std::size_t x = 0, y = 0, width = 0, height = 0;
};

// Estimates the parts of relMSE. `replicates` are pictures of the reference's size, (height,
// width). The means are over the pixels of `region` (all, where it is empty) that are finite in
// every replicate and in the reference. The result is the same to the last bit for any number of
// threads.
[[nodiscard]] ErrorParts decompose(std::span<const std::vector<Rgb>> replicates,
                                   std::span<const Rgb> reference, std::size_t width,
                                   double epsilon, const Rectangle& region = {});

// The 97.5% quantile of Student's t.
[[nodiscard]] double student_t(std::size_t degrees_of_freedom);

}  // namespace psf::study
