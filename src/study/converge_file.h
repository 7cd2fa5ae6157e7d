// A convergence study in its folder: converge.json and converge.csv; what it says about time.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/converge.h"
#include "study/study_file.h"

namespace psf::study {

// Seconds of a pass, as psf-render's --json has them.
struct RenderTime {
  double render = 0;  // without dump
  double dump = 0;
};

// How much a set gains at n passes against the same renderer without filter, whose error falls as
// 1 / n beyond what was measured.
struct SpeedUp {
  std::size_t series = 0;  // index
  std::uint64_t n = 0;
  double equal_time = 0;   // unfiltered error at the same time over the filtered error
  double equal_error = 0;  // time to the same error without filter over the time with it
};

// relMSE of every series but the first, which is the unfiltered one; empty where the sets' times
// were not measured. Unfiltered pictures need no dump.
[[nodiscard]] std::vector<SpeedUp> speed_ups(std::span<const ConvergeSeries> series,
                                             const RenderTime& time);

// A measured slope beside the one that theory gives for it.
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
  std::span<const Metric> measured;
  std::vector<ConvergeSeries> series;
  std::optional<RenderTime> time;
  std::vector<SpeedUp> speed_ups;
  std::vector<SlopeCheck> checks;  // of an analytic scene
  bool with_pictures = false;      // names are those of picture_name()
};

// "0001.n0004.exr", "unfiltered.n0004.exr"; series 0 is the unfiltered one.
[[nodiscard]] std::string picture_name(std::size_t series, std::uint64_t n);

[[nodiscard]] Json to_json(const ConvergeReport& report);
// A line a series and n.
[[nodiscard]] std::string to_csv(const ConvergeReport& report);

}  // namespace psf::study
