// The files converge.json and converge.csv of a convergence study, and gains at equal time and
// error.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/converge.h"
#include "study/render_time.h"
#include "study/study_file.h"

namespace psf::study {

// The gain of a set at n passes over the same renderer without filter. Beyond the measured passes,
// the error without filter is assumed to fall as 1 / n.
struct SpeedUp {
  std::size_t series = 0;  // index
  std::uint64_t n = 0;
  double equal_time = 0;   // unfiltered error at the same time over the filtered error
  double equal_error = 0;  // time to the same error without filter over the time with it
};

// The gains in relMSE of every series but the first, which is unfiltered. Empty where the sets'
// times were not measured. The time without filter does not include the dump.
[[nodiscard]] std::vector<SpeedUp> speed_ups(std::span<const ConvergeSeries> series,
                                             const RenderTime& time);

// A measured slope, and the slope that theory predicts.
struct SlopeCheck {
  std::size_t series = 0;  // index
  std::string quantity;    // "bias_sq", "variance"
  double measured = 0, theory = 0;
  bool passed = false;
};

struct ConvergeReport {
  std::string version;
  std::vector<Json> inputs;  // describe_input() of each replicate
  Json reference, metrics;
  std::span<const metrics::Metric> measured;
  std::vector<ConvergeSeries> series;
  std::optional<RenderTime> time;
  std::vector<SpeedUp> speed_ups;
  std::vector<SlopeCheck> checks;  // for an analytic scene
  bool with_pictures = false;      // pictures were written, with names by picture_name()
};

// The file name of a picture, "0001.n0004.exr", or "unfiltered.n0004.exr" for series 0.
[[nodiscard]] std::string picture_name(std::size_t series, std::uint64_t n);

[[nodiscard]] Json to_json(const ConvergeReport& report);
// A flat object for each series and n: id, parameters, and the values of the point by name.
[[nodiscard]] Json to_rows(const ConvergeReport& report);
// The same as a table, one line each.
[[nodiscard]] std::string to_csv(const ConvergeReport& report);

// The paths of converge.json and converge.csv in a folder.
struct ConvergePaths {
  explicit ConvergePaths(const std::string& folder);

  std::string json, csv;
};

}  // namespace psf::study
