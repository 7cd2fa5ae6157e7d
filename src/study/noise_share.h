// Whence the noise of the picture without filter comes: from u, which no parameter of the filter
// reaches, or from alpha c. README.md [noise].
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/vec.h"
#include "filter/records.h"
#include "filter/roles.h"
#include "study/dump.h"
#include "study/passes.h"

namespace psf::study {

// Parts of the relative variance that a picture without filter has, of luminance: over
// g^2 + epsilon, means over the pixels that have at least two paths.
struct NoiseShare {
  double unfiltered = 0;    // of u
  double contribution = 0;  // of alpha c
  double covariance = 0;    // twice the covariance of both; may be below 0
  std::uint64_t pixels = 0;

  [[nodiscard]] double variance() const { return unfiltered + contribution + covariance; }
  // What u has of the variance, half of the covariance included: [noise]. Cut to [0, 1], which it
  // leaves where u and alpha c make up for each other; NaN where there is no noise but rounding.
  [[nodiscard]] double share() const {
    constexpr double kRounding = 1e-9;
    return variance() > kRounding * (unfiltered + contribution)
               ? std::clamp((unfiltered + covariance / 2) / variance(), 0.0, 1.0)
               : std::numeric_limits<double>::quiet_NaN();
  }
};

// One camera's sums.
class NoiseMoments {
 public:
  explicit NoiseMoments(const filter::CameraView& camera);

  // A path of the picture without filter; what is not finite is left out. A pixel's paths from one
  // thread, in path order.
  void add(std::uint32_t pixel, const Rgb& u, const Rgb& alpha_c);
  // `epsilon`: of relMSE. The same bits for any number of threads.
  [[nodiscard]] NoiseShare share(double epsilon = 1e-2) const;

  static constexpr std::uint64_t kBytesAPixel = 5 * sizeof(double) + sizeof(std::uint64_t);

 private:
  struct Pixel {
    std::uint64_t paths = 0;
    double u = 0, s = 0;            // means of luminance, s of alpha c
    double uu = 0, ss = 0, us = 0;  // sums of products of differences from them
  };
  // Of the mean luminance around each pixel.
  [[nodiscard]] std::vector<double> guess() const;

  std::size_t width_, height_;
  std::vector<Pixel> pixels_;
};

// Adds records [first, last) of a block, those that the picture without filter is made of, to the
// moments of their cameras. The same for any number of threads.
void add_noise(const filter::Records& records, std::span<const filter::Role> roles,
               std::size_t first, std::size_t last, std::span<NoiseMoments> moments);

// Reads the passes of a dump and returns the shares of each camera, of the paths that
// `--sources 1/sources` chooses; what is averaged plays no part. Throws what Dump throws,
// Error{interrupted}.
[[nodiscard]] std::vector<NoiseShare> noise_shares(const Dump& dump, const PassSelection& passes,
                                                   double epsilon = 1e-2,
                                                   std::uint32_t sources = 1);

}  // namespace psf::study
