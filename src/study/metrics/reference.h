// A reference picture prepared once, against which any number of pictures is measured.
//
// All metrics of 256 x 256 pixels take 16 ms on one thread, of 1920 x 1080 0.6 s, and the reference
// as much once: FLIP 9 ms of it, SSIM 5, the others 2, relMSE alone 0.5. That is 250 ns a pixel,
// where its 8 powers and 500 multiply-adds, 4 at once, would take about 110.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/vec.h"
#include "study/metrics/errors.h"
#include "study/metrics/metrics.h"

namespace psf::study {

class Reference {
 public:
  // (height, width) linear colours, row 0 at the top. Measures `metrics`; SSIM and FLIP cost most.
  // Throws Error{usage} for options that make no sense.
  Reference(std::span<const Rgb> picture, std::size_t width, const MetricOptions& options = {},
            std::span<const Metric> metrics = kAllMetrics);
  ~Reference();
  Reference(Reference&&) noexcept;
  Reference& operator=(Reference&&) noexcept;

  [[nodiscard]] std::size_t width() const;
  [[nodiscard]] std::size_t height() const;
  [[nodiscard]] const MetricOptions& options() const;
  [[nodiscard]] std::span<const Metric> metrics() const;

  // Of a picture of the same size. A pixel that is not finite in either is left out and counted; in
  // its neighbours' windows it stands as in the reference. May be called from several threads; the
  // same bits for any number of threads.
  [[nodiscard]] Errors errors(std::span<const Rgb> picture) const;
  [[nodiscard]] Metrics measure(std::span<const Rgb> picture) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace psf::study
