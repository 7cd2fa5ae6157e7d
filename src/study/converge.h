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

#include "filter/parameters/parameters.h"
#include "metrics/metrics.h"
#include "metrics/reference.h"
#include "run/dump.h"
#include "study/replicates.h"
#include "study/theory.h"

namespace psf::study {

// The results of one set of parameters after n passes.
struct ConvergePoint {
  std::uint64_t n = 0;       // passes
  metrics::Metrics metrics;  // means over the replicates
  ErrorParts parts;
  Theory theory;         // for the first replicate; all 0 without filter
  double neighbors = 0;  // M(n): mean over the queries of all blocks so far, and the replicates
  double radius = 0;     // mean in the last block, pixels
  std::optional<double> filter_seconds;  // a separate run over n passes of the first replicate
};

struct ConvergeSeries {
  std::optional<filter::Parameters> parameters;  // none: unfiltered
  std::vector<ConvergePoint> points;             // one for each n
};

struct ConvergeRequest {
  std::span<const filter::Parameters> sets;
  std::vector<std::uint64_t> n;  // numbers of passes, ascending; every dump has at least the last
  std::size_t camera = 0;
  std::optional<run::VertexRule> vertex;  // of all dumps
  bool with_times = true;  // measure filter_seconds, which takes one more run per set
  // The limit in bytes of the filter's memory, as for --max-memory; the replicates' pictures may
  // take as much again. Sets that do not fit wait for another traversal.
  std::optional<std::uint64_t> max_memory;
  Rectangle region;  // the pixels that `parts` are measured over; empty: all
  // Called with each picture of the first replicate. `set`: number of the set; none: unfiltered.
  std::function<void(std::optional<std::size_t> set, std::uint64_t n, const std::vector<Rgb>&)>
      on_picture;
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths
};

// The powers of two below `passes`: 1, 2, 4, ..., and then `passes` itself.
[[nodiscard]] std::vector<std::uint64_t> powers_up_to(std::uint64_t passes);

// Throws Error{bad_input} where the dumps have different scenes, cameras, or the same seed,
// Error{usage} where one has fewer passes: what converge() throws before it works.
void check_replicates(std::span<const std::string> dumps, std::uint64_t passes);

// Runs a convergence study. `dumps`: the replicates, of one scene and with different seeds. The
// first series returned is unfiltered; then there is one for each set, in their order. The picture
// at n is what psf filter --passes 0:n gives. Throws what check_replicates() and filter_many()
// throw.
[[nodiscard]] std::vector<ConvergeSeries> converge(std::span<const std::string> dumps,
                                                   const metrics::Reference& reference,
                                                   std::span<const Rgb> reference_picture,
                                                   const ConvergeRequest& convergence);

// The slope d log(value) / d log(n) between two points; NaN where a value is not positive.
[[nodiscard]] double local_slope(double n0, double value0, double n1, double value1);

}  // namespace psf::study
