// Error pictures: where a picture is wrong, as values or in false colour.
#pragma once

#include <string>

#include "study/metrics/color_map.h"
#include "study/metrics/errors.h"
#include "study/metrics/metrics.h"

namespace psf::study {

struct ErrorScale {
  double max = 0;         // the error shown in the brightest colour; 0 has the darkest
  std::size_t above = 0;  // pixels whose error is larger
};

// What a map of errors holds: the metric, but MSE for PSNR and "1 - SSIM" for SSIM.
[[nodiscard]] const char* error_name(Metric metric);

// Up to `max`; where that is 0, up to the error that 99% of the pixels do not exceed.
[[nodiscard]] ErrorScale error_scale(const Errors& errors, Metric metric, double max = 0);

// .exr: the errors in channel Y, not-a-number where picture or reference is not finite, with the
// metric and its settings as attributes. .png: false colour up to `scale`; not finite is cyan.
// `color_map`: one of kColorMaps. Throws Error{usage} for another extension, Error{io}.
void write_error_picture(const std::string& path, const Errors& errors, Metric metric,
                         const MetricOptions& options, const ErrorScale& scale,
                         const std::string& color_map);

}  // namespace psf::study
