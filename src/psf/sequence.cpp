#include "psf/sequence.h"

#include <utility>

#include "psf/dump_state.h"
#include "run/sequence.h"

namespace psf {

struct Sequence::State {
  explicit State(const std::string& path)
      : sequence(path), cameras(cameras_of(*sequence.frame(sequence.frames().front()).dump)) {}

  run::Sequence sequence;
  std::vector<Camera> cameras;
};

Sequence::Sequence(const std::string& path) : state_(std::make_shared<const State>(path)) {}

const std::string& Sequence::path() const {
  return state_->sequence.path();
}
const std::vector<std::uint32_t>& Sequence::frames() const {
  return state_->sequence.frames();
}
const std::vector<Camera>& Sequence::cameras() const {
  return state_->cameras;
}

FilterResult Sequence::filter(std::uint32_t frame, const Parameters& parameters,
                              const FrameOptions& options) const {
  const run::WindowTexts window = {options.window, options.relit, options.positions};
  window.validate();
  const run::Sequence sequence = state_->sequence.at(run::vertex_rule_of(options.vertex));
  const run::DumpFrame one = sequence.frame(frame);
  run::FilterRequest request;
  request.passes = one.passes;
  request.window = sequence.around(frame, *one.dump, window);
  if (!options.layers) request.layers = run::PictureLayers::none();
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  return filter_with(*one.dump, std::move(request), parameters);
}

}  // namespace psf
