// The metrics that compare a picture with a reference: their names, options and values.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

namespace psf::metrics {

// x: picture, r: reference, both linear; means are over pixels and colour channels.
enum class Metric : int {
  rel_mse,  // mean of (x - r)^2 / (r^2 + epsilon) (Rousselle 2011)
  mse,      // mean of (x - r)^2
  smape,    // mean of |x - r| / (|x| + |r| + epsilon), at most 1 (Vogels 2018)
  mape,     // mean of |x - r| / (|r| + epsilon)
  psnr,     // 10 log10(1 / MSE), of linear values and peak 1, in dB
  ssim,     // structural similarity of the displayed picture, 1: equal (ssim.h)
  flip      // LDR-FLIP of the displayed picture, 0: equal, at most 1 (flip.h)
};

inline constexpr std::size_t kMetricCount = 7;
inline constexpr std::array<Metric, kMetricCount> kAllMetrics = {
    Metric::rel_mse, Metric::mse,  Metric::smape, Metric::mape,
    Metric::psnr,    Metric::ssim, Metric::flip};
// The metrics that compare one pixel at a time; they take an eighth of the time of all metrics.
inline constexpr std::array<Metric, 5> kPixelMetrics = {Metric::rel_mse, Metric::mse, Metric::smape,
                                                        Metric::mape, Metric::psnr};

struct MetricOptions {
  // Added to the denominators of relative errors, against division by zero: where the reference is
  // dark, they measure absolute error.
  double epsilon = 1e-2;
  // For SSIM and FLIP, in stops: they compare both pictures times 2^exposure, through tone_map() of
  // film/display.h.
  float exposure = 0;
  // For FLIP: 67 pixels per degree are a 4K screen, 0.7 m wide, seen from 0.7 m.
  double pixels_per_degree = 3840 * 3.14159265358979323846 / 180;

  void validate() const;  // throws Error{usage}
};

// The name of a metric: "relMSE", "MSE", "SMAPE", "MAPE", "PSNR", "SSIM" or "FLIP".
[[nodiscard]] const char* name(Metric metric);
// The metric of a name in upper or lower case. Throws Error{usage} that lists the names.
[[nodiscard]] Metric parse_metric(std::string_view text);
[[nodiscard]] bool lower_is_better(Metric metric);
// The options that a metric depends on, as text: "epsilon 0.01"; empty where there are none.
[[nodiscard]] std::string settings(Metric metric, const MetricOptions& options);

// A value of each metric; NaN for metrics that were not asked for, or where no pixel was left.
struct Metrics {
  Metrics() { values.fill(std::numeric_limits<double>::quiet_NaN()); }
  double operator[](Metric metric) const { return values[static_cast<std::size_t>(metric)]; }
  double& operator[](Metric metric) { return values[static_cast<std::size_t>(metric)]; }

  std::array<double, kMetricCount> values;
  std::size_t pixels = 0;      // number of pixels measured: in the region, finite, not trimmed
  std::size_t trimmed = 0;     // number left out by each metric because their errors are largest
  std::size_t non_finite = 0;  // number left out because picture or reference is not finite
};

}  // namespace psf::metrics
