// A whole dump through the filter, block by block, into pictures.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/parameters.h"
#include "filter/statistics.h"
#include "study/dump.h"
#include "study/memory.h"
#include "study/noise_share.h"
#include "study/passes.h"
#include "study/pictures.h"

namespace psf::study {

struct FilterRun {
  filter::Parameters parameters;
  PassSelection passes;  // act as a dump of their own, but that blocks of b^m stay where they are
  PictureLayers layers;
  std::vector<std::uint64_t>
      snapshots;  // pictures after so many of the passes, ascending, each at least 1
  // All paths of the first `passes` passes, each filtered with its whole block. One entry a camera.
  std::function<void(std::uint64_t passes, std::span<const CameraPictures>)> on_snapshot;
  std::function<void(std::uint64_t done, std::uint64_t total)>
      on_progress;  // paths, after every block
  // Bytes, kept by the estimate of memory.h: first the next block is no longer read ahead, which is
  // slower and gives the same bytes. Not set: no limit.
  std::optional<std::uint64_t> max_memory;
  bool with_noise = false;  // of the picture without filter; see FilterOutcome::noise
};

struct FilterOutcome {
  std::vector<CameraPictures> pictures;  // one a camera
  std::vector<NoiseMoments> noise;       // one a camera where the run asked for them, else none
  filter::Statistics statistics;
  std::uint64_t passes = 0, blocks = 0;
  std::uint64_t overflows =
      0;                    // paths left out because throughput times average is no finite float
  double seconds_read = 0;  // waiting for the reader, which works beside the filter
  double seconds_film = 0;  // adding up pictures
  MemoryEstimate memory;
};

// The next block is read while one is filtered. Memory: MemoryEstimate, whatever the length of the
// dump. Throws what Dump, Blocks and average() throw, of each block once those before it are in the
// pictures; Error{usage} for passes or snapshots that the dump does not have; Error{limit} where
// `max_memory` cannot be kept, before any work; Error{interrupted}.
[[nodiscard]] FilterOutcome filter_dump(const Dump& dump, const FilterRun& run);

// The same for a dump that is still being written: calls `on_pictures` whenever passes were
// committed, with what filter_dump() would give for all there are by then, until the dump is closed
// or has the last pass of the selection. Blocks that are whole are filtered once. Calls `wait`
// between two looks at the file; it may throw to stop. Without snapshots and progress. What it
// returns `on_pictures` was given last.
[[nodiscard]] FilterOutcome follow_dump(
    Dump& dump, const FilterRun& run, const std::function<void(const FilterOutcome&)>& on_pictures,
    const std::function<void()>& wait);

}  // namespace psf::study
