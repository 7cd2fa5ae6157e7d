// Discrete distributions sampled by inversion.
#include "render/light/distribution.h"

namespace psf::render {

Distribution::Distribution(std::span<const float> weights) : cumulative_(weights.size() + 1, 0) {
  for (const float w : weights) total_ += double{w};
  if (!(total_ > 0)) return;
  double sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    sum += double{weights[k]};
    cumulative_[k + 1] = static_cast<float>(sum / total_);
  }
  cumulative_.back() = 1;
}

std::size_t Distribution::sample(float& u) const {
  // The first value above u ends the share: a share of probability 0 is never chosen.
  const auto end = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u);
  const auto k = static_cast<std::size_t>(end - cumulative_.begin()) - 1;
  u = std::clamp((u - cumulative_[k]) / probability(k), 0.0f, 0x1.fffffep-1f);
  return k;
}

}  // namespace psf::render
