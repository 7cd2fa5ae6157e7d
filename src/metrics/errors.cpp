#include "metrics/errors.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/parallel.h"
#include "metrics/ssim.h"

namespace psf::metrics {
namespace {

constexpr std::size_t kValueGrain = 8192;  // values a partial sum

// The partial sums are of fixed ranges and added in order: the same for any number of threads.
template <class Term>
double sum(std::size_t count, const Term& term) {
  std::vector<double> parts(core::range_count(count, kValueGrain));
  core::parallel_for(count, kValueGrain, [&](std::size_t begin, std::size_t end) {
    double part = 0;
    for (std::size_t i = begin; i < end; ++i) part += term(i);
    parts[begin / kValueGrain] = part;
  });
  double total = 0;
  for (const double part : parts) total += part;
  return total;
}

std::size_t trimmed_count(std::size_t count, double share) {
  return static_cast<std::size_t>(std::llround(share * static_cast<double>(count)));
}

// The mean of `values` without the `left_out` largest. Which of equal values are left out makes no
// difference.
double mean_of_smallest(const std::vector<double>& values, std::size_t left_out) {
  const std::size_t kept = values.size() - std::min(left_out, values.size());
  if (kept == 0) return std::numeric_limits<double>::quiet_NaN();
  const auto count = static_cast<double>(kept);
  if (left_out == 0) return sum(kept, [&](std::size_t i) { return values[i]; }) / count;
  std::vector<double> sorted = values;
  const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(kept - 1);
  std::nth_element(sorted.begin(), last, sorted.end());
  const double largest = *last;
  const double below =
      sum(values.size(), [&](std::size_t i) { return values[i] < largest ? values[i] : 0; });
  const auto equal = static_cast<double>(
      kept - static_cast<std::size_t>(std::count_if(values.begin(), values.end(),
                                                    [&](double v) { return v < largest; })));
  return (below + equal * largest) / count;
}

// `region` without what lies closer than `margin` to the border of the picture; all of it where
// nothing is left.
Region inside(const Region& region, std::size_t margin, std::size_t width, std::size_t height) {
  const auto cut = [margin](std::size_t begin, std::size_t size, std::size_t whole) {
    const std::size_t first = std::max(begin, margin);
    const std::size_t end = std::min(begin + size, whole - std::min(whole, margin));
    return std::pair(first, end > first ? end - first : 0);
  };
  const auto [x, columns] = cut(region.x, region.width, width);
  const auto [y, rows] = cut(region.y, region.height, height);
  return columns == 0 || rows == 0 ? region : Region{x, y, columns, rows};
}

}  // namespace

Errors::Errors(std::size_t width, std::size_t height, std::span<const Metric> metrics)
    : width_(width), height_(height), non_finite_(width * height) {
  for (const Metric metric : metrics) {
    const Metric stored = metric == Metric::psnr ? Metric::mse : metric;
    maps_[static_cast<std::size_t>(stored)].resize(width * height);
  }
}

std::span<const double> Errors::map(Metric metric) const {
  const Metric stored = metric == Metric::psnr ? Metric::mse : metric;
  return maps_[static_cast<std::size_t>(stored)];
}

std::span<double> Errors::map(Metric metric) {
  const Metric stored = metric == Metric::psnr ? Metric::mse : metric;
  return maps_[static_cast<std::size_t>(stored)];
}

std::vector<double> Errors::chosen(Metric metric, const Region& region) const {
  const Region counted =
      metric == Metric::ssim ? inside(region, kSsimRadius, width_, height_) : region;
  const std::span<const double> errors = map(metric);
  std::vector<double> values;
  values.reserve(counted.width * counted.height);
  for (std::size_t y = counted.y; y < counted.y + counted.height; ++y) {
    for (std::size_t i = y * width_ + counted.x; i < y * width_ + counted.x + counted.width; ++i) {
      if (non_finite_[i] == 0) values.push_back(errors[i]);
    }
  }
  return values;
}

Metrics Errors::mean(const Choice& choice) const {
  const Region region = choice.region.value_or(Region{0, 0, width_, height_});
  assert(region.x + region.width <= width_ && region.y + region.height <= height_);
  assert(choice.trim >= 0 && choice.trim < 1);
  Metrics result;
  for (std::size_t y = region.y; y < region.y + region.height; ++y) {
    const auto row = non_finite_.begin() + static_cast<std::ptrdiff_t>(y * width_ + region.x);
    result.non_finite +=
        static_cast<std::size_t>(std::count_if(row, row + static_cast<std::ptrdiff_t>(region.width),
                                               [](std::uint8_t flag) { return flag != 0; }));
  }
  const std::size_t finite = region.width * region.height - result.non_finite;
  result.trimmed = trimmed_count(finite, choice.trim);
  result.pixels = finite - result.trimmed;
  for (const Metric metric : kAllMetrics) {
    if (!has(metric)) continue;
    const std::vector<double> values = chosen(metric, region);
    const double mean = mean_of_smallest(values, trimmed_count(values.size(), choice.trim));
    switch (metric) {
      case Metric::psnr:
        result[metric] = -10 * std::log10(mean);
        break;
      case Metric::ssim:
        result[metric] = 1 - mean;
        break;
      default:
        result[metric] = mean;
    }
  }
  return result;
}

}  // namespace psf::metrics
