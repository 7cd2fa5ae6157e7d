// Takes the filter apart on one dump: its weights one after another, blocks against each other, and
// one iteration after another.
#pragma once

#include <array>
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

enum class AblationPart : std::uint8_t {
  // The picture without filter, without weights, and with each weight that is on, added to those
  // before it in the order of filter::kTerms.
  weights,
  // Every pass as a block of its own, two blocks, one block.
  blocks,
  // The first pass without filter, and filtered once, twice, ... kIterations times.
  iterations
};
inline constexpr std::array<AblationPart, 3> kAblationParts = {
    AblationPart::weights, AblationPart::blocks, AblationPart::iterations};
inline constexpr std::uint32_t kIterations = 8;

// "weights", "blocks", "iterations".
[[nodiscard]] const char* name(AblationPart part);

struct AblationRow {
  AblationPart part = AblationPart::weights;
  std::string label;                             // "+ normal 0.95", "2 blocks of 8 passes"
  std::optional<filter::Parameters> parameters;  // none: unfiltered
  std::size_t first = 0, last = 0;               // passes [first, last)
  // What follows is measured.
  metrics::Metrics metrics;  // NaN without a reference
  double mean = 0;           // luminance of the picture
  double change = 0;         // of the mean, as a share of that of the same unfiltered
  double neighbors = 0;      // mean number per query
  std::uint64_t orphans = 0, left_out = 0;  // numbers of records in all blocks
  double seconds = 0;                       // 0 for unfiltered, which comes with the row behind it
};

// The change of the mean: "+0.06%".
[[nodiscard]] std::string change_text(const AblationRow& row);

struct AblateRequest {
  filter::Parameters parameters;  // each row has these but for what it is about
  run::PassSelection passes;
  std::size_t camera = 0;
  const metrics::Reference* reference = nullptr;  // null: nothing is compared
  std::optional<std::uint64_t> max_memory;        // bytes, of each run of the filter
  // Called for each row when it is done, with its picture.
  std::function<void(const AblationRow&, const std::vector<Rgb>& picture)> on_row;
  // Called now and then; counts paths over all runs of the filter, again in every iteration.
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;
};

// The rows that ablate() will measure, in their order. Where the estimator does not iterate there
// are no iterations, and blocks that `max_memory` has no room for are left out; each adds a line to
// `notes`. Throws Error{usage} for passes that the dump does not have and for parameters that do
// not go together, Error{limit} where the other rows have no room, and what Dump::select() throws.
[[nodiscard]] std::vector<AblationRow> plan_ablation(const run::Dump& dump,
                                                     const AblateRequest& request,
                                                     std::vector<std::string>& notes);

// Measures `rows`, which plan_ablation() made, one after the other. Every picture is that of
// run::filter_dump() to the last bit, which is why rows do not share a traversal: what many radii
// share is right but for rounding, and no two rows differ in the radius alone. Throws what
// run::filter_dump() throws.
void ablate(const run::Dump& dump, const AblateRequest& request, std::vector<AblationRow>& rows);

}  // namespace psf::study
