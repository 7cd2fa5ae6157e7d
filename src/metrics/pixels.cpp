#include "metrics/pixels.h"

#include <cmath>

#include "core/parallel.h"

namespace psf::metrics {

void measure_pixels(std::span<const Rgb> picture, std::span<const Rgb> reference, double epsilon,
                    Errors& errors) {
  constexpr std::size_t kGrain = 4096;
  const auto fill = [&](Metric metric, const auto& error) {
    const std::span<double> map = errors.map(metric);
    core::parallel_for(map.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) sum += error(double{picture[i][k]}, double{reference[i][k]});
        map[i] = sum / 3;
      }
    });
  };
  // The maps of metrics that were not asked for are empty.
  fill(Metric::rel_mse, [=](double x, double r) { return (x - r) * (x - r) / (r * r + epsilon); });
  fill(Metric::mse, [](double x, double r) { return (x - r) * (x - r); });
  fill(Metric::smape,
       [=](double x, double r) { return std::abs(x - r) / (std::abs(x) + std::abs(r) + epsilon); });
  fill(Metric::mape, [=](double x, double r) { return std::abs(x - r) / (std::abs(r) + epsilon); });
}

}  // namespace psf::metrics
