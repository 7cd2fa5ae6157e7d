// The input of every engine: records to average, with their roles, radii and weights.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "filter/roles.h"
#include "filter/statistics.h"
#include "filter/weights.h"
#include "search/search.h"

namespace psf::filter {

// All spans are indexed by record number.
struct Problem {
  const Records& records;
  const Roles& roles;             // at least one source
  std::span<const float> radius;  // r_i
  const Weights& weights;
  std::span<const float> area;  // A_j of [disk]; empty: [average]
  // The sources are no queries, and a query without one in its ball gets 0: there are no orphans.
  bool sources_apart = false;

  // w_ij w_ji: whether each of two records could have brought what the other did.
  [[nodiscard]] bool alike(std::uint32_t i, std::uint32_t j) const {
    return weights.pass(i, j, radius[i]) && weights.pass(j, i, radius[j]);
  }
};

// What is averaged, and where the averages go, both by record number.
struct Averaged {
  std::span<const Rgb> values;
  std::span<Rgb> out;
};

// Applies [average] or [disk], and keeps its search structure from one application to the next.
// There are two engines for balls: that of plain.h defines the result, that of engine/ is fast.
class Engine {
 public:
  virtual ~Engine() = default;

  // One application of [average], of [fit] or of [disk] to everything in `all`, at least one, which shares the
  // search: weights do not ask for values. For every query i it writes the average of the values of
  // the sources to out[i], the same bits whatever else is averaged, and the number of sources to
  // neighbors[i], 0 for an orphan. Adds its counts to `statistics`. The result is the same for any
  // number of threads. Throws Error{interrupted} on ^C.
  virtual void apply(std::span<const Averaged> all, BallFit fit, bool count_refusals,
                     std::span<std::uint32_t> neighbors, Statistics& statistics) = 0;
};

// The search of the engines that search for each record.
[[nodiscard]] inline search::Kind search_of(EngineKind kind) {
  return kind == EngineKind::brute ? search::Kind::brute : search::Kind::flann;
}

// `problem` must outlive the engine.
[[nodiscard]] std::unique_ptr<Engine> make_engine(EngineKind kind, const Problem& problem);

}  // namespace psf::filter
