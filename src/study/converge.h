// How the error falls as samples accumulate: pictures of every set of parameters after n = 1, 2, 4,
// ... passes, over independent replicates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filter/parameters.h"
#include "study/dump.h"
#include "study/metrics/metrics.h"
#include "study/metrics/reference.h"
#include "study/replicates.h"
#include "study/theory.h"

namespace psf::study {

// A set of parameters after n passes.
struct ConvergePoint {
  std::uint64_t n = 0;  // passes
  Metrics metrics;      // means over the replicates
  ErrorParts parts;
  Theory theory;         // of the first replicate; all 0 without filter
  double neighbors = 0;  // M(n): of a query of all blocks so far, the mean over the replicates
  double radius = 0;     // of the last block, pixels
  std::optional<double> filter_seconds;  // of a run of its own over n passes of the first replicate
};

struct ConvergeSeries {
  std::optional<filter::Parameters> parameters;  // none: unfiltered
  std::vector<ConvergePoint> points;             // one an n
};

struct Convergence {
  std::span<const filter::Parameters> sets;
  std::vector<std::uint64_t> n;  // ascending; all dumps have so many passes
  std::size_t camera = 0;
  bool with_times = true;  // one more run a set
  // Bytes: of the filter as --max-memory has it, and as much again for pictures of replicates; sets
  // that do not fit wait for another traversal.
  std::optional<std::uint64_t> max_memory;
  Rectangle region;  // empty: all; of `parts` alone
  // A picture of the first replicate; `set`: number of the set, none: unfiltered.
  std::function<void(std::optional<std::size_t> set, std::uint64_t n, const std::vector<Rgb>&)>
      on_picture;
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths
};

// 1, 2, 4, ... and `passes` itself.
[[nodiscard]] std::vector<std::uint64_t> powers_up_to(std::uint64_t passes);

// `dumps`: the replicates, of one scene and of other seeds each. The first series is unfiltered,
// then one a set, in their order; the picture at n is what psf filter --passes 0:n gives. Throws
// Error{bad_input} where the dumps have different cameras or the same seed, Error{usage} where one
// has too few passes, and what filter_many() throws.
[[nodiscard]] std::vector<ConvergeSeries> converge(std::span<const std::string> dumps,
                                                   const Reference& reference,
                                                   std::span<const Rgb> reference_picture,
                                                   const Convergence& convergence);

// d log(value) / d log(n) from one point to the next; NaN where a value is not positive.
[[nodiscard]] double local_slope(double n0, double value0, double n1, double value1);

}  // namespace psf::study
