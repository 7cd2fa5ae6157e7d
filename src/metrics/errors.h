// The error of every pixel of a picture against a reference, and means over chosen pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "metrics/metrics.h"

namespace psf::metrics {

struct Region {  // pixels [x, x + width) x [y, y + height), row 0 at the top
  std::size_t x = 0, y = 0, width = 0, height = 0;
};

// The pixels that a mean is taken over.
struct Choice {
  std::optional<Region> region;  // inside the picture; not set: the whole picture
  double trim = 0;  // share of the pixels, in [0, 1), to leave out: those with the largest errors
};

class Errors {
 public:
  // Errors of 0 at every pixel, for the given metrics.
  Errors(std::size_t width, std::size_t height, std::span<const Metric> metrics);

  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  [[nodiscard]] bool has(Metric metric) const { return !map(metric).empty(); }

  // The errors, (height, width), in the metric's own measure, except that PSNR has those of MSE,
  // and SSIM has 1 - SSIM.
  [[nodiscard]] std::span<const double> map(Metric metric) const;
  [[nodiscard]] std::span<double> map(Metric metric);
  // (height, width): not 0 where the picture or the reference is not finite. Such pixels are in no
  // mean.
  [[nodiscard]] std::span<const std::uint8_t> non_finite() const { return non_finite_; }
  [[nodiscard]] std::span<std::uint8_t> non_finite() { return non_finite_; }

  // The means over the chosen pixels. For SSIM only pixels whose whole window lies in the picture
  // count (Wang 2004), unless there is none among those chosen.
  [[nodiscard]] Metrics mean(const Choice& choice = {}) const;

 private:
  [[nodiscard]] std::vector<double> chosen(Metric metric, const Region& region) const;

  std::size_t width_, height_;
  std::array<std::vector<double>, kMetricCount> maps_;  // empty: not measured
  std::vector<std::uint8_t> non_finite_;
};

}  // namespace psf::metrics
