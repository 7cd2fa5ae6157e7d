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
#include "filter/parameters.h"
#include "study/dump.h"
#include "study/metrics/metrics.h"
#include "study/metrics/reference.h"
#include "study/passes.h"

namespace psf::study {

// What a row of a sweep says.
struct SweepRow {
  filter::Parameters parameters;
  Metrics metrics;
  double neighbors = 0;                      // mean of a query
  double first_radius = 0, last_radius = 0;  // pixels, mean of the first block and of the last
  std::uint64_t orphans = 0, left_out = 0;   // records, of all blocks
  double seconds = 0;  // of the traversal, with reading and pictures, that `shared` rows share
  std::size_t shared = 1;
};

struct Sweep {
  std::span<const filter::Parameters> rows;
  PassSelection passes;
  std::size_t camera = 0;
  std::optional<std::uint64_t> max_memory;  // bytes
  // Rows in the order in which they are done, with the picture.
  std::function<void(std::size_t row, const SweepRow&, const std::vector<Rgb>& picture)> on_row;
  // After the rows of a traversal: a good moment to keep what there is.
  std::function<void()> on_traversal;
  // Once, before the first row: the same paths without filter.
  std::function<void(const Metrics&, const std::vector<Rgb>& picture)> on_unfiltered;
  std::function<void(std::uint64_t done, std::uint64_t total)>
      on_progress;  // paths, all traversals
};

// Rows that share everything but r0 and delta share a traversal, as many as the memory allows.
// Throws what filter_many() throws.
void run_sweep(const Dump& dump, const Reference& reference, const Sweep& sweep);

}  // namespace psf::study
