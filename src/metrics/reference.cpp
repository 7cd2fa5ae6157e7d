#include "metrics/reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "metrics/displayed.h"
#include "metrics/flip.h"
#include "metrics/pixels.h"
#include "metrics/ssim.h"

namespace psf::metrics {
namespace {

bool finite(const Rgb& color) {
  return std::isfinite(color.x) && std::isfinite(color.y) && std::isfinite(color.z);
}

}  // namespace

struct Reference::State {
  std::vector<Rgb> picture;            // black where it is not finite
  std::vector<std::uint8_t> unusable;  // not 0 where it is not finite
  std::size_t width = 0;
  MetricOptions options;
  std::vector<Metric> metrics;
  std::optional<Ssim> ssim;
  std::optional<Flip> flip;

  [[nodiscard]] bool measures(Metric metric) const {
    return std::find(metrics.begin(), metrics.end(), metric) != metrics.end();
  }
};

Reference::Reference(std::span<const Rgb> picture, std::size_t width, const MetricOptions& options,
                     std::span<const Metric> metrics) {
  options.validate();
  assert(width > 0 && !picture.empty() && picture.size() % width == 0);
  auto state = std::make_unique<State>();
  state->picture.assign(picture.begin(), picture.end());
  state->unusable.resize(picture.size());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (finite(picture[i])) continue;
    state->picture[i] = Rgb(0);
    state->unusable[i] = 1;
  }
  state->width = width;
  state->options = options;
  state->metrics.assign(metrics.begin(), metrics.end());
  const bool ssim = state->measures(Metric::ssim), flip = state->measures(Metric::flip);
  if (ssim || flip) {
    const Displayed shown = displayed(state->picture, width, options.exposure);
    if (ssim) state->ssim.emplace(shown);
    if (flip) state->flip.emplace(shown, options.pixels_per_degree);
  }
  state_ = std::move(state);
}

Reference::~Reference() = default;
Reference::Reference(Reference&&) noexcept = default;
Reference& Reference::operator=(Reference&&) noexcept = default;

std::size_t Reference::width() const {
  return state_->width;
}
std::size_t Reference::height() const {
  return state_->picture.size() / state_->width;
}
const MetricOptions& Reference::options() const {
  return state_->options;
}
std::span<const Metric> Reference::metrics() const {
  return state_->metrics;
}

Errors Reference::errors(std::span<const Rgb> picture) const {
  const State& state = *state_;
  assert(picture.size() == state.picture.size());
  constexpr std::size_t kGrain = 8192;
  Errors errors(width(), height(), state.metrics);
  std::vector<Rgb> clean(picture.size());
  const std::span<std::uint8_t> non_finite = errors.non_finite();
  core::parallel_for(picture.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool usable = state.unusable[i] == 0 && finite(picture[i]);
      non_finite[i] = usable ? 0 : 1;
      clean[i] = usable ? picture[i] : state.picture[i];
    }
  });
  measure_pixels(clean, state.picture, state.options.epsilon, errors);
  if (state.ssim || state.flip) {
    const Displayed shown = displayed(clean, state.width, state.options.exposure);
    if (state.ssim) state.ssim->measure(shown, errors.map(Metric::ssim));
    if (state.flip) state.flip->measure(shown, errors.map(Metric::flip));
  }
  return errors;
}

Metrics Reference::measure(std::span<const Rgb> picture) const {
  return errors(picture).mean();
}

}  // namespace psf::metrics
