// How far a picture is from a reference.
#pragma once

#include <span>

#include "core/vec.h"

namespace psf::study {

// Where the reference is dark, relMSE counts absolute error: the usual guard against division by
// zero.
constexpr double kRelMseEpsilon = 1e-2;

struct Metrics {
  double mse = 0;      // mean squared error over pixels and colour channels
  double rel_mse = 0;  // mean of (x - r)^2 / (r^2 + kRelMseEpsilon), over pixels and colour
                       // channels (Rousselle 2011)
  double psnr = 0;     // 10 log10(1 / mse), for pictures of peak 1
};

// Pictures of the same size, linear colour. Not-a-number where a picture has a non-finite value.
[[nodiscard]] Metrics compare(std::span<const Rgb> picture, std::span<const Rgb> reference);

}  // namespace psf::study
