#include "run/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/number.h"
#include "core/seconds.h"

namespace psf::run {
namespace {

// The paths of a frame, as far as its dump has them.
filter::PathRange paths_of(const DumpFrame& frame) {
  const std::vector<std::uint64_t>& bounds = frame.dump->pass_bounds();
  const std::size_t passes = bounds.size() - 1;
  return {bounds[frame.passes.first], bounds[std::min(passes, frame.passes.last.value_or(passes))]};
}

bool same_layers(const ChannelSet& a, const ChannelSet& b) {
  return std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(),
                    [](const LightLayer& x, const LightLayer& y) { return x.name == y.name; });
}

bool same_size(const filter::CameraView& a, const filter::CameraView& b) {
  return a.width == b.width && a.height == b.height;
}

// The threshold that a text says, "off": none.
std::optional<double> relit_of(const std::string& text) {
  if (text == "off") return std::nullopt;
  const std::optional<double> number = core::parse_number<double>(text);
  if (number && *number > 0) return number;
  throw Error(ErrorCode::usage, fmt::format("`relit`: '{}': write a number above 0, or off", text));
}

}  // namespace

void WindowTexts::validate() const {
  if (width % 2 == 0) {
    throw Error(
        ErrorCode::usage,
        fmt::format("`window {}`: as many frames before as behind; give an odd number", width));
  }
  for (const auto& [text, name] :
       {std::pair(&relit, "relit"), std::pair(&positions, "positions")}) {
    if (text->empty() || width > 1) continue;
    throw Error(ErrorCode::usage,
                fmt::format("`{}`: is about other frames; give `window K`", name));
  }
  if (!relit.empty()) static_cast<void>(relit_of(relit));
  if (!positions.empty() && positions != "rest" && positions != "world") {
    throw Error(ErrorCode::usage, fmt::format("`positions`: '{}': write rest or world", positions));
  }
}

filter::WindowTerms WindowTexts::terms(const Dump& dump) const {
  validate();
  filter::WindowTerms terms;
  if (!relit.empty()) terms.relit = relit_of(relit);
  terms.rest = positions.empty() ? dump.has("rest_position") : positions == "rest";
  return terms;
}

std::vector<std::pair<std::string, std::string>> describe(const Window& window) {
  if (window.others.empty()) return {};
  return {{"window", std::to_string(window.width)},
          {"relit", window.terms.relit ? fmt::format("{:g}", *window.terms.relit) : "off"},
          {"positions", window.terms.rest ? "rest" : "world"}};
}

void check_window(const Dump& dump, const Window& window, const filter::Parameters& parameters) {
  if (window.others.empty()) return;
  window.terms.validate_with(parameters);
  for (const DumpFrame& frame : window.others) {
    const std::vector<filter::CameraView>&own = dump.cameras(), &its = frame.dump->cameras();
    if (std::equal(own.begin(), own.end(), its.begin(), its.end(), same_size)) continue;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: has other cameras, or pictures of another size, than {}; render "
                            "all frames alike",
                            frame.dump->reader().path(), dump.reader().path()));
  }
}

WindowReader::WindowReader(std::uint64_t first_path, const Window& window,
                           const filter::Parameters& parameters, const Select& select)
    : first_path_(first_path), window_(window), parameters_(parameters) {
  for (const DumpFrame& frame : window.others) {
    channels_.push_back(select(*frame.dump));
    if (same_layers(channels_.front(), channels_.back())) continue;
    throw Error(ErrorCode::bad_input,
                frame.dump->reader().path() +
                    ": has other layers of the light than the frames before it; `layers none` does "
                    "without them");
  }
}

filter::Estimates WindowReader::estimate(const BlockLoop::Visit& visit,
                                         std::span<const float> radius) {
  filter::FrameWindow frames(visit.records, radius, visit.block, parameters_, window_.terms);
  for (std::size_t k = 0; k < window_.others.size(); ++k) {
    core::throw_if_interrupted("no picture was written");
    const DumpFrame& frame = window_.others[k];
    const filter::PathRange all = paths_of(frame);
    const filter::PathRange same_place = {
        std::min(all.last, all.first + (visit.paths.first - first_path_)),
        std::min(all.last, all.first + (visit.paths.last - first_path_))};
    if (same_place.size() == 0) continue;  // its last passes are not rendered yet
    const auto start = core::Clock::now();
    frame.dump->read(same_place, channels_[k], records_);
    seconds_ += core::seconds_since(start);
    filter::Block block = visit.block;
    block.first_path = same_place.first;
    block.cameras = frame.dump->cameras();
    block.shade_rate = frame.dump->metadata().shade_rate;
    frames.add(records_.view(), block);
  }
  filter::Estimates estimates = frames.finish();
  counts_ += frames.counts();
  return estimates;
}

}  // namespace psf::run
