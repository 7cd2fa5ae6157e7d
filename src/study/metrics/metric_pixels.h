// The metrics that look at one pixel at a time.
#pragma once

#include <span>

#include "core/vec.h"
#include "study/metrics/errors.h"

namespace psf::study {

// Into the maps that `errors` has of relMSE, MSE, SMAPE and MAPE: each pixel's mean over R, G, B.
void measure_pixels(std::span<const Rgb> picture, std::span<const Rgb> reference, double epsilon,
                    Errors& errors);

}  // namespace psf::study
