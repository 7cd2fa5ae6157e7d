#include "run/passes.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace psf::run {

std::size_t last_pass(const Dump& dump, const PassSelection& selection) {
  const std::size_t passes = dump.pass_bounds().size() - 1;
  const std::size_t last = selection.last.value_or(passes);
  if (selection.first >= last || last > passes) {
    throw Error(ErrorCode::usage, fmt::format("{}: has passes 0:{}, {}:{} is no part of them",
                                              dump.reader().path(), passes, selection.first, last));
  }
  return last;
}

filter::Block describe_block(const Dump& dump, const filter::Blocks& blocks, std::uint64_t k,
                             filter::RadiusCount count) {
  const filter::PathRange range = blocks[k];
  const auto pixels = static_cast<double>(dump.pixels());
  const double samples = static_cast<double>(range.last - blocks.all().first) / pixels;
  const double within = static_cast<double>(range.size()) / pixels;
  // Paths enumerated by pixel fill whole pixels even where the block is less than a pass.
  const bool global = dump.metadata().enumeration == "global";
  return {range.first, count == filter::RadiusCount::samples ? samples : static_cast<double>(k + 1),
          global ? within : std::max(1.0, within), dump.cameras(), dump.metadata().shade_rate};
}

}  // namespace psf::run
