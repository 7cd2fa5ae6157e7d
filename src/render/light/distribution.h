// Discrete distributions sampled by inversion, which keeps low-discrepancy points well distributed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace psf::render {

// Probabilities proportional to weights >= 0. Where all weights are 0 or there are none, total() is
// 0 and sample() must not be called.
class Distribution {
 public:
  Distribution() = default;
  explicit Distribution(std::span<const float> weights);

  [[nodiscard]] std::size_t size() const {
    return cumulative_.empty() ? 0 : cumulative_.size() - 1;
  }
  [[nodiscard]] double total() const { return total_; }
  [[nodiscard]] float probability(std::size_t k) const {
    return cumulative_[k + 1] - cumulative_[k];
  }
  // The k whose part of [0, 1) holds u. u is replaced by its place within this part, which is again
  // uniform in [0, 1).
  [[nodiscard]] std::size_t sample(float& u) const;

 private:
  std::vector<float> cumulative_;  // size + 1 values from 0 to 1
  double total_ = 0;
};

}  // namespace psf::render
