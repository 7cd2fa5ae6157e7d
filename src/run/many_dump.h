// Filters a whole dump for many radii at once, with pictures on the way.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/statistics.h"
#include "run/dump.h"
#include "run/many_pictures.h"
#include "run/memory.h"
#include "run/passes.h"

namespace psf::run {

struct ManyResult {
  std::vector<ManyPictures> pictures;          // one per camera, part after part
  std::vector<filter::Statistics> statistics;  // one per radius; the seconds are for all together
  // The mean r_i over the queries of the last and of the first block, in pixels, one per radius.
  std::vector<double> last_radius, first_radius;
  std::uint64_t passes = 0, blocks = 0;
  std::uint64_t overflows = 0;  // paths left out of a picture, over all radii
  double seconds = 0;           // time of the run so far, without on_pictures
  MemoryEstimate memory;
};

struct ManyRequest {
  filter::Parameters parameters;      // the radius is replaced by each of `radii`
  std::vector<filter::Radius> radii;  // all with the same basis and count
  PassSelection passes;
  // The numbers of passes after which on_pictures is called, ascending, each at least 1; the last
  // is that of all passes. on_pictures gets what a run over the first n passes alone would give.
  // Empty: all passes.
  std::vector<std::uint64_t> n;
  std::function<void(std::uint64_t n, const ManyResult&)> on_pictures;
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths
  std::optional<std::uint64_t> max_memory;                                   // bytes
  // The number of parts with pictures of their own. Blocks go to the parts in turn, so that the
  // parts are independent; they are filtered as in the whole run. Fewer blocks than parts:
  // Error{usage}.
  std::size_t parts = 1;
};

// Makes the same pictures as filter_dump() for each radius, except for rounding, with one traversal
// per block. Throws Error{limit} where `max_memory` does not allow the pictures of all radii at
// once (see radii_at_once()), and what filter_dump() throws.
[[nodiscard]] ManyResult filter_many(const Dump& dump, const ManyRequest& run);

// The number of the run's radii that its memory allows at once, at least 1. The others need another
// run.
[[nodiscard]] std::size_t radii_at_once(const Dump& dump, const ManyRequest& run);

}  // namespace psf::run
