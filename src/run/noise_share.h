// The sources of the noise in the picture without filter: u, which no parameter of the filter
// changes, and alpha c. README.md [noise].
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
#include "run/dump.h"
#include "run/passes.h"

namespace psf::run {

// The parts of the relative variance of the luminance in a picture without filter: variance over
// g^2 + epsilon, mean over the pixels that have at least two paths.
struct NoiseShare {
  double unfiltered = 0;    // variance of u
  double contribution = 0;  // variance of alpha c
  double covariance = 0;    // twice the covariance of u and alpha c; may be below 0
  std::uint64_t pixels = 0;

  [[nodiscard]] double variance() const { return unfiltered + contribution + covariance; }
  // The share of u in the variance, with half of `covariance`: [noise]. It is clamped to [0, 1],
  // which it may leave where u and alpha c compensate each other; NaN where there is no noise but
  // rounding.
  [[nodiscard]] double share() const {
    constexpr double kRounding = 1e-9;
    return variance() > kRounding * (unfiltered + contribution)
               ? std::clamp((unfiltered + covariance / 2) / variance(), 0.0, 1.0)
               : std::numeric_limits<double>::quiet_NaN();
  }
};

// The moments of one camera's pixels.
class NoiseMoments {
 public:
  explicit NoiseMoments(const filter::CameraView& camera);

  // Adds a path of the picture without filter; a path that is not finite is left out. Add the paths
  // of a pixel from one thread, in path order.
  void add(std::uint32_t pixel, const Rgb& u, const Rgb& alpha_c);
  // `epsilon` is that of relMSE. The result is the same to the last bit for any number of threads.
  [[nodiscard]] NoiseShare share(double epsilon = 1e-2) const;

  static constexpr std::uint64_t kBytesAPixel = 5 * sizeof(double) + sizeof(std::uint64_t);

 private:
  struct Pixel {
    std::uint64_t paths = 0;
    double u = 0, s = 0;            // means of the luminance of u and of alpha c
    double uu = 0, ss = 0, us = 0;  // sums of products of differences from these means
  };
  // g at each pixel: the median_around() of the mean luminance.
  [[nodiscard]] std::vector<double> guess() const;

  std::size_t width_, height_;
  std::vector<Pixel> pixels_;
};

// Adds those of the records [first, last) of a block that are in the picture without filter to the
// moments of their cameras. The result is the same for any number of threads.
void add_noise(const filter::Records& records, std::span<const filter::Role> roles,
               std::size_t first, std::size_t last, std::span<NoiseMoments> moments);

// Reads the passes of a dump and returns the shares of each camera, for the paths that `--sources
// 1/sources` chooses. The filter's averages have no influence. Throws what Dump throws, and
// Error{interrupted}.
[[nodiscard]] std::vector<NoiseShare> noise_shares(const Dump& dump, const PassSelection& passes,
                                                   double epsilon = 1e-2,
                                                   std::uint32_t sources = 1);

}  // namespace psf::run
