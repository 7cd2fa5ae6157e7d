#include "metrics/ssim.h"

#include <cmath>

#include "film/display.h"

namespace psf::metrics {
namespace {

constexpr float kC1 = 0.01f * 0.01f, kC2 = 0.03f * 0.03f;
// Taken off all values, so that the variances keep more of float's digits.
constexpr float kMiddle = 0.5f;

Kernel window() {
  constexpr double kSigma = 1.5;
  double weights[2 * kSsimRadius + 1], sum = 0;
  for (std::size_t i = 0; i <= 2 * kSsimRadius; ++i) {
    const double x = (static_cast<double>(i) - kSsimRadius) / kSigma;
    sum += weights[i] = std::exp(-x * x / 2);
  }
  Kernel kernel;
  for (const double weight : weights) kernel.push_back(static_cast<float>(weight / sum));
  return kernel;
}

Plane windowed(const Plane& plane) {
  static const Kernel kernel = window();
  return along_columns(along_rows(plane, kernel), kernel);
}

Plane product(const Plane& a, const Plane& b) {
  Plane result(a.width(), a.height());
  for_pixels(result,
             [&](std::size_t y, std::size_t x) { result.row(y)[x] = a.row(y)[x] * b.row(y)[x]; });
  return result;
}

}  // namespace

Ssim::Channel Ssim::prepare(const Plane& linear) {
  Channel channel;
  channel.values = Plane(linear.width(), linear.height());
  for_pixels(linear, [&](std::size_t y, std::size_t x) {
    channel.values.row(y)[x] = film::srgb_from_linear(linear.row(y)[x]) - kMiddle;
  });
  channel.mean = windowed(channel.values);
  channel.mean_sq = windowed(product(channel.values, channel.values));
  return channel;
}

Ssim::Ssim(const Displayed& reference)
    : reference_{prepare(reference[0]), prepare(reference[1]), prepare(reference[2])} {}

void Ssim::measure(const Displayed& picture, std::span<double> errors) const {
  for (std::size_t k = 0; k < reference_.size(); ++k) {
    const Channel& r = reference_[k];
    const Channel c = prepare(picture[k]);
    const Plane both = windowed(product(c.values, r.values));
    const std::size_t width = both.width();
    // Equal pictures give exactly 1: each factor above then equals the one below, bit for bit.
    for_pixels(both, [&](std::size_t y, std::size_t x) {
      const float mean_c = c.mean.row(y)[x], mean_r = r.mean.row(y)[x];
      const float light_c = mean_c + kMiddle, light_r = mean_r + kMiddle;
      const float variance_c = c.mean_sq.row(y)[x] - mean_c * mean_c;
      const float variance_r = r.mean_sq.row(y)[x] - mean_r * mean_r;
      const float covariance = both.row(y)[x] - mean_c * mean_r;
      const float above = (2 * (light_c * light_r) + kC1) * (2 * covariance + kC2);
      const float below =
          (light_c * light_c + light_r * light_r + kC1) * (variance_c + variance_r + kC2);
      errors[y * width + x] += (1 - static_cast<double>(above / below)) / 3;
    });
  }
}

}  // namespace psf::metrics
