// Many sets of parameters on one dump, each measured against a reference.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"
#include "filter/parameters/parameters.h"
#include "metrics/metrics.h"
#include "metrics/reference.h"
#include "run/dump.h"
#include "run/passes.h"

namespace psf::study {

// The results of one row of a sweep.
struct SweepRow {
  filter::Parameters parameters;
  metrics::Metrics metrics;
  double neighbors = 0;                      // mean number per query
  double first_radius = 0, last_radius = 0;  // means in the first and the last block, pixels
  std::uint64_t orphans = 0, left_out = 0;   // numbers of records in all blocks
  double seconds = 0;  // time of the traversal that `shared` rows share, with reading and pictures
  std::size_t shared = 1;
};

struct SweepRequest {
  std::span<const filter::Parameters> rows;
  run::PassSelection passes;
  std::size_t camera = 0;
  std::optional<std::uint64_t> max_memory;  // bytes
  // Called for each row when it is done, with its picture.
  std::function<void(std::size_t row, const SweepRow&, const std::vector<Rgb>& picture)> on_row;
  // Called after the rows of a traversal, so that results can be saved.
  std::function<void()> on_traversal;
  // Called once, before the first row, with the picture of the same paths without filter.
  std::function<void(const metrics::Metrics&, const std::vector<Rgb>& picture)> on_unfiltered;
  // Called now and then; counts paths over all traversals.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;
};

// Runs a sweep. Rows that differ only in r0 and delta share a traversal, as many as the memory
// allows. Throws what filter_many() throws.
void run_sweep(const run::Dump& dump, const metrics::Reference& reference,
               const SweepRequest& sweep);

}  // namespace psf::study
