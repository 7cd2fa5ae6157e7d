// Error pictures, which show where a picture is wrong, as values or in false colour.
#pragma once

#include <string>

#include "metrics/color_map.h"
#include "metrics/errors.h"
#include "metrics/metrics.h"

namespace psf::metrics {

struct ErrorScale {
  double max = 0;         // the error shown in the brightest colour; error 0 has the darkest
  std::size_t above = 0;  // number of pixels with a larger error
};

// The name of what the errors of a metric measure: the metric itself, but "MSE" for PSNR and "1 -
// SSIM" for SSIM.
[[nodiscard]] const char* error_name(Metric metric);

// A scale up to `max`, or where `max` is 0, up to the error that 99% of the pixels do not exceed.
[[nodiscard]] ErrorScale error_scale(const Errors& errors, Metric metric, double max = 0);

// Writes an error picture. An .exr has the errors in channel Y, NaN where picture or reference is
// not finite, and the metric and its settings as attributes. A .png has false colours up to
// `scale`, and cyan where picture or reference is not finite. `color_map`: one of kColorMaps.
// Throws Error{usage} for another extension, Error{io}.
void write_error_picture(const std::string& path, const Errors& errors, Metric metric,
                         const MetricOptions& options, const ErrorScale& scale,
                         const std::string& color_map);

}  // namespace psf::metrics
