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
  const auto& frames = dump.metadata().frames;
  if (frames && frames->count > 1 &&
      selection.first / frames->passes != (last - 1) / frames->passes) {
    throw Error(
        ErrorCode::usage,
        fmt::format(
            "{}: has the frames {}:{}, and passes {}:{} are of several, which would be mixed; "
            "choose one by `passes`, {} from 0, {}, ... on, or psf filter's `frame`",
            dump.reader().path(), frames->first, frames->first + std::uint64_t{frames->count},
            selection.first, last, frames->passes, frames->passes));
  }
  return last;
}

PassSelection passes_of_frame(const Dump& dump, std::uint32_t frame) {
  const auto& frames = dump.metadata().frames;
  const std::string& path = dump.reader().path();
  if (!frames) throw Error(ErrorCode::usage, path + ": tells of no frames; leave out `frame`");
  if (frame < frames->first || frame - frames->first >= frames->count) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: has the frames {}:{}, {} is none of them", path, frames->first,
                            frames->first + std::uint64_t{frames->count}, frame));
  }
  const std::size_t passes = dump.pass_bounds().size() - 1;
  const std::size_t first = (frame - frames->first) * frames->passes;
  if (first >= passes) {
    throw Error(ErrorCode::usage, fmt::format("{}: has no pass of frame {} yet", path, frame));
  }
  if (frames->count == 1) return {0, std::nullopt};
  return {first, std::min<std::size_t>(first + frames->passes, passes)};
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
