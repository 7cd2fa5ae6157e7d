// The passes of a dump that a run takes, and the description of their blocks for the filter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "filter/blocks.h"
#include "filter/records.h"
#include "run/dump.h"

namespace psf::run {

// Passes [first, last) of a dump, counted from 0; `last` not set: to the end.
struct PassSelection {
  std::size_t first = 0;
  std::optional<std::size_t> last;
};

// The end of the selection. Throws Error{usage} where it is empty, has passes that the dump does not
// have, or passes of several frames, which are several pictures.
[[nodiscard]] std::size_t last_pass(const Dump& dump, const PassSelection& selection);

// The passes of a frame, as far as the dump has them. Throws Error{usage} where it has none.
[[nodiscard]] PassSelection passes_of_frame(const Dump& dump, std::uint32_t frame);

// Describes block k of `blocks`; n of [radius] counts what `count` says.
[[nodiscard]] filter::Block describe_block(const Dump& dump, const filter::Blocks& blocks,
                                           std::uint64_t k, filter::RadiusCount count);

}  // namespace psf::run
