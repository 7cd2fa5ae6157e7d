#include "filter_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "core/error.h"
#include "core/numbered_name.h"
#include "pass_range.h"
#include "vertex_option.h"

namespace psf::tools {
namespace {

// Whether a name is that of a file a frame.
bool is_of_frames(const std::string& input) {
  return core::is_numbered(input) && !std::filesystem::exists(input);
}

}  // namespace

FrameRuns::FrameRuns(const FilterOptions& options, const std::string& vertex) : options_(options) {
  options.window.validate();
  const std::optional<run::VertexRule> rule = run::vertex_rule_of(vertex);
  if (!is_of_frames(options.input)) {
    whole_ = std::make_shared<const run::Dump>(options.input, rule);
    if (options.frame) static_cast<void>(run::passes_of_frame(*whole_, *options.frame));
    const bool numbered =
        std::any_of(options.outputs.begin(), options.outputs.end(), core::is_numbered);
    const bool several = numbered && whole_->metadata().frames && !options.follow;
    if (!options.frame && options.window.width == 1 && !several) return;
  }
  sequence_.emplace(options.input, rule);
  choose_frames();
}

void FrameRuns::choose_frames() {
  frames_ = options_.frame ? std::vector{*options_.frame} : sequence_->frames();
  if (!options_.passes.empty()) {
    throw Error(ErrorCode::usage, "--passes: are of one frame; choose it by --frame");
  }
  if (frames_.size() == 1) return;
  for (const std::string& output : options_.outputs) {
    if (core::is_numbered(output)) continue;
    throw Error(
        ErrorCode::usage,
        fmt::format("{}: a picture a frame needs {} in its name, for the frame's number; or "
                    "choose a frame by --frame",
                    output, core::kNumberMark));
  }
}

FrameRun FrameRuns::operator[](std::size_t k) const {
  if (!sequence_) {
    return {{whole_, parse_passes(options_.passes)}, std::nullopt, {}, options_.outputs};
  }
  const std::uint32_t number = frames_[k];
  FrameRun one{sequence_->frame(number), number, {}, options_.outputs};
  for (std::string& name : one.outputs) name = core::numbered(name, number);
  if (options_.window.width > 1) {
    one.window = sequence_->around(number, *one.frame.dump, options_.window);
  }
  return one;
}

std::vector<std::string> FrameRuns::inputs() const {
  return sequence_ ? sequence_->files() : std::vector{options_.input};
}

}  // namespace psf::tools
