// The metrics that a picture is measured with against a reference: their names, what they depend
// on, and a value of each.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

namespace psf::study {

// x: picture, r: reference, both linear; means are over pixels and colour channels.
enum class Metric : int {
  rel_mse,  // mean of (x - r)^2 / (r^2 + epsilon) (Rousselle 2011)
  mse,      // mean of (x - r)^2
  smape,    // mean of |x - r| / (|x| + |r| + epsilon), at most 1 (Vogels 2018)
  mape,     // mean of |x - r| / (|r| + epsilon)
  psnr,     // 10 log10(1 / MSE), of linear values and peak 1, in dB
  ssim,     // structural similarity of the displayed picture, 1: equal (metric_ssim.h)
  flip      // LDR-FLIP of the displayed picture, 0: equal, at most 1 (metric_flip.h)
};

inline constexpr std::size_t kMetricCount = 7;
inline constexpr std::array<Metric, kMetricCount> kAllMetrics = {
    Metric::rel_mse, Metric::mse,  Metric::smape, Metric::mape,
    Metric::psnr,    Metric::ssim, Metric::flip};
// Those that look at one pixel at a time: an eighth of the time of all.
inline constexpr std::array<Metric, 5> kPixelMetrics = {Metric::rel_mse, Metric::mse, Metric::smape,
                                                        Metric::mape, Metric::psnr};

struct MetricOptions {
  // Where the reference is dark, relative errors count absolute error: the usual guard against
  // division by zero.
  double epsilon = 1e-2;
  // What SSIM and FLIP see: both pictures times 2^exposure through the tone curve of
  // film/display.h.
  float exposure = 0;
  // FLIP's distance: 67, a 4K screen of 0.7 m at 0.7 m.
  double pixels_per_degree = 3840 * 3.14159265358979323846 / 180;

  void validate() const;  // throws Error{usage}
};

// "relMSE", "MSE", "SMAPE", "MAPE", "PSNR", "SSIM", "FLIP".
[[nodiscard]] const char* name(Metric metric);
// From its name in upper or lower case; throws Error{usage} with the names there are.
[[nodiscard]] Metric parse_metric(std::string_view text);
[[nodiscard]] bool lower_is_better(Metric metric);
// What its value depends on, as text: "epsilon 0.01"; empty where it is nothing.
[[nodiscard]] std::string settings(Metric metric, const MetricOptions& options);

// A value of each metric; not-a-number for what was not asked for, or where no pixel was left.
struct Metrics {
  Metrics() { values.fill(std::numeric_limits<double>::quiet_NaN()); }
  double operator[](Metric metric) const { return values[static_cast<std::size_t>(metric)]; }
  double& operator[](Metric metric) { return values[static_cast<std::size_t>(metric)]; }

  std::array<double, kMetricCount> values;
  std::size_t pixels = 0;      // measured: of the region, finite, not trimmed
  std::size_t trimmed = 0;     // left out because their error is largest, by each metric its own
  std::size_t non_finite = 0;  // left out because picture or reference is not finite there
};

}  // namespace psf::study
