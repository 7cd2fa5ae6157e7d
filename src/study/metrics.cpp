#include "study/metrics.h"

#include <cassert>
#include <cmath>

namespace psf::study {

Metrics compare(std::span<const Rgb> picture, std::span<const Rgb> reference) {
  assert(picture.size() == reference.size() && !picture.empty());
  double sum_sq = 0, sum_relative_sq = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double r = reference[i][k];
      const double difference_sq = (picture[i][k] - r) * (picture[i][k] - r);
      sum_sq += difference_sq;
      sum_relative_sq += difference_sq / (r * r + kRelMseEpsilon);
    }
  }
  const auto count = static_cast<double>(3 * picture.size());
  Metrics metrics;
  metrics.mse = sum_sq / count;
  metrics.rel_mse = sum_relative_sq / count;
  metrics.psnr = -10 * std::log10(metrics.mse);
  return metrics;
}

}  // namespace psf::study
