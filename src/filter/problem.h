// What there is to average over, the same for every engine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "filter/parameters.h"
#include "filter/records.h"
#include "filter/roles.h"
#include "filter/statistics.h"
#include "filter/weights.h"

namespace psf::filter {

// All spans by record number.
struct Problem {
  const Records& records;
  const Roles& roles;             // at least one source
  std::span<const float> radius;  // r_i
  const Weights& weights;
  std::span<const float> area;  // A_j of [disk]; empty: [average]
};

// Holds what it has built over the sources from one application to the next. Two engines: that of
// plain.h says what is right, that of engine/ is fast.
class Engine {
 public:
  virtual ~Engine() = default;

  // One application of [average] or [disk]: out[i] for every query from `values` of the sources,
  // and neighbors[i], how many of them it was; 0 for an orphan. Adds to `statistics` what it
  // counts. Same result for any number of threads. Throws Error{interrupted} on ^C.
  virtual void average(std::span<const Rgb> values, bool count_refusals, std::span<Rgb> out,
                       std::span<std::uint32_t> neighbors, Statistics& statistics) = 0;
};

// `problem` must outlive the engine.
[[nodiscard]] std::unique_ptr<Engine> make_engine(search::Kind kind, const Problem& problem);

}  // namespace psf::filter
