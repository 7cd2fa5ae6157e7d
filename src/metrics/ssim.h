// SSIM: Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to
// Structural Similarity" (2004): Gaussian window of 11 x 11 pixels, sigma 1.5, K1 = 0.01, K2 =
// 0.03, L = 1, on the sRGB values of the displayed picture, mean of R, G and B. Sums are in float,
// so each pixel is right to 1e-4.
#pragma once

#include <array>
#include <span>

#include "metrics/displayed.h"

namespace psf::metrics {

inline constexpr std::size_t kSsimRadius = 5;  // radius of the window, pixels

class Ssim {
 public:
  explicit Ssim(const Displayed& reference);
  // Writes 1 - SSIM of every pixel to `errors`, (height, width).
  void measure(const Displayed& picture, std::span<double> errors) const;

 private:
  struct Channel {
    Plane values, mean, mean_sq;  // sRGB - 0.5; the means are over the window
  };
  static Channel prepare(const Plane& linear);

  std::array<Channel, 3> reference_;
};

}  // namespace psf::metrics
