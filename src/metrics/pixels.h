// The metrics that compare one pixel at a time.
#pragma once

#include <span>

#include "core/vec.h"
#include "metrics/errors.h"

namespace psf::metrics {

// Writes the errors of every pixel, each the mean over R, G, B, to those of the maps of relMSE,
// MSE, SMAPE and MAPE that `errors` has.
void measure_pixels(std::span<const Rgb> picture, std::span<const Rgb> reference, double epsilon,
                    Errors& errors);

}  // namespace psf::metrics
