// A whole dump through the filter for many radii at once, with pictures on the way.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/parameters.h"
#include "filter/statistics.h"
#include "study/dump.h"
#include "study/many_pictures.h"
#include "study/memory.h"
#include "study/passes.h"

namespace psf::study {

struct ManyOutcome {
  std::vector<ManyPictures> pictures;          // one a camera, part after part
  std::vector<filter::Statistics> statistics;  // one a radius; the seconds are of all together
  // Mean over the queries of the last block, in pixels, one a radius; those of the first block.
  std::vector<double> last_radius, first_radius;
  std::uint64_t passes = 0, blocks = 0;
  std::uint64_t overflows = 0;  // paths left out of a picture, over all radii
  double seconds = 0;           // of everything up to here, but on_snapshot
  MemoryEstimate memory;
};

struct ManyRun {
  filter::Parameters parameters;      // the radius is replaced
  std::vector<filter::Radius> radii;  // of one basis and count
  PassSelection passes;
  // Numbers of passes, ascending, each at least 1 and the last one all: what on_snapshot is given
  // after `n` is what a run over the first n passes alone gives. Empty: all passes.
  std::vector<std::uint64_t> snapshots;
  std::function<void(std::uint64_t n, const ManyOutcome&)> on_snapshot;
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths
  std::optional<std::uint64_t> max_memory;                                   // bytes
  // Blocks go to the pictures of so many parts in turn, which then are independent, filtered as the
  // whole run filters them. At least so many blocks, else Error{usage}.
  std::size_t parts = 1;
};

// The same pictures as filter_dump() for each radius, within rounding, from one traversal a block.
// Where `max_memory` does not allow the pictures of all radii at once, it refuses: see
// radii_at_once(). Throws what filter_dump() throws.
[[nodiscard]] ManyOutcome filter_many(const Dump& dump, const ManyRun& run);

// How many of the run's radii its memory allows at once, at least 1; the rest is another run's.
[[nodiscard]] std::size_t radii_at_once(const Dump& dump, const ManyRun& run);

}  // namespace psf::study
