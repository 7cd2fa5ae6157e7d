#include "metrics/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace psf::metrics {
namespace {

constexpr std::array<const char*, kMetricCount> kNames = {"relMSE", "MSE",  "SMAPE", "MAPE",
                                                          "PSNR",   "SSIM", "FLIP"};

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

void require(bool fine, const char* what, const char* range) {
  if (!fine) throw Error(ErrorCode::usage, fmt::format("{} must be {}", what, range));
}

}  // namespace

void MetricOptions::validate() const {
  require(std::isfinite(epsilon) && epsilon > 0, "epsilon", "finite and above 0");
  require(std::abs(exposure) <= 64, "the exposure", "in [-64, 64] stops");
  require(pixels_per_degree >= 1 && pixels_per_degree <= 1000, "the pixels per degree",
          "in [1, 1000]");
}

const char* name(Metric metric) {
  return kNames[static_cast<std::size_t>(metric)];
}

Metric parse_metric(std::string_view text) {
  for (const Metric metric : kAllMetrics) {
    if (same_letters(text, name(metric))) return metric;
  }
  throw Error(ErrorCode::usage, fmt::format("there is no metric \"{}\", use one of {}", text,
                                            fmt::join(kNames, ", ")));
}

bool lower_is_better(Metric metric) {
  return metric != Metric::psnr && metric != Metric::ssim;
}

std::string settings(Metric metric, const MetricOptions& options) {
  switch (metric) {
    case Metric::mse:
      return "";
    case Metric::psnr:
      return "peak 1";
    case Metric::ssim:
      return fmt::format("tone-mapped sRGB, exposure {:g}", options.exposure);
    case Metric::flip:
      return fmt::format("tone-mapped, exposure {:g}, {:.4g} pixels per degree", options.exposure,
                         options.pixels_per_degree);
    case Metric::rel_mse:
    case Metric::smape:
    case Metric::mape:
      break;
  }
  return fmt::format("epsilon {:g}", options.epsilon);
}

}  // namespace psf::metrics
