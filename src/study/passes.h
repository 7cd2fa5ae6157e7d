// Which passes of a dump a run takes, and what the filter is to know of their blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "filter/blocks.h"
#include "filter/records.h"
#include "study/dump.h"

namespace psf::study {

// Passes [first, last) of a dump, counted from 0; `last` not set: to the end.
struct PassSelection {
  std::size_t first = 0;
  std::optional<std::size_t> last;
};

// The end of the selection; throws Error{usage} for passes that the dump does not have, or none.
[[nodiscard]] std::size_t last_pass(const Dump& dump, const PassSelection& selection);

// Block k of `blocks`, with n of [radius] as `count` asks.
[[nodiscard]] filter::Block describe_block(const Dump& dump, const filter::Blocks& blocks,
                                           std::uint64_t k, filter::RadiusCount count);

}  // namespace psf::study
