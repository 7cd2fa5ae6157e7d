// Filters a whole dump, block by block, into pictures.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/statistics.h"
#include "run/dump.h"
#include "run/memory.h"
#include "run/noise_share.h"
#include "run/passes.h"
#include "run/pictures.h"
#include "run/window.h"

namespace psf::run {

struct FilterRequest {
  filter::Parameters parameters;
  PassSelection passes;  // treated as a dump of their own, but blocks of b^m stay in place
  PictureLayers layers;
  // Numbers of passes after which pictures are wanted, ascending, each at least 1.
  std::vector<std::uint64_t> snapshots;
  // Called for each snapshot, with the pictures of the first `passes` passes, one per camera. Each
  // path is filtered with its whole block.
  std::function<void(std::uint64_t passes, std::span<const CameraPictures>)> on_snapshot;
  // Called after every block, with numbers of paths.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;
  // The limit in bytes for the estimate of memory.h; not set: none. Where reading ahead would
  // exceed it, blocks are not read ahead, which is slower and gives the same pictures.
  std::optional<std::uint64_t> max_memory;
  bool with_noise = false;  // measure FilterResult::noise
  Window window;            // other frames whose vertices count too; not with follow_dump()
};

struct FilterResult {
  std::vector<CameraPictures> pictures;  // one per camera
  std::vector<NoiseMoments> noise;       // one per camera with FilterRequest::with_noise, else none
  filter::Statistics statistics;
  std::uint64_t passes = 0, blocks = 0;
  std::uint64_t not_finite_in_layers = 0;  // values of layers of the light that count as 0
  std::uint64_t not_finite_coverage = 0;   // values of alpha that count as 1
  std::uint64_t overflows = 0;             // paths left out because their radiance overflows
  filter::WindowCounts window;             // balls in other frames, and those that counted
  double seconds_read = 0;  // time spent waiting for the reader, which works beside the filter
  double seconds_film = 0;  // time spent adding up pictures
  MemoryEstimate memory;
};

// Throws Error{usage} for parameters that do not go together, and for passes or snapshots that the
// dump does not have: what filter_dump() throws before it looks at memory.
void check(const Dump& dump, const FilterRequest& run);

// Filters a dump. The next block is read while one is filtered. The memory is that of
// MemoryEstimate, whatever the length of the dump. Throws Error{limit} before any work where
// `max_memory` cannot be kept, Error{interrupted}, and what check(), Dump, Blocks and estimate()
// throw; the errors of a block come after the blocks before it are in the pictures.
[[nodiscard]] FilterResult filter_dump(const Dump& dump, const FilterRequest& run);

// Filters a dump that is still being written, until it is closed or has the last pass of the
// selection. Whenever passes were committed, it calls `on_pictures` with what filter_dump() would
// return for all passes so far. Whole blocks are filtered only once. Between two looks at the file
// it calls `wait`, which may throw to stop. There are no snapshots and no progress. Returns what
// `on_pictures` got last.
[[nodiscard]] FilterResult follow_dump(Dump& dump, const FilterRequest& run,
                                       const std::function<void(const FilterResult&)>& on_pictures,
                                       const std::function<void()>& wait);

}  // namespace psf::run
