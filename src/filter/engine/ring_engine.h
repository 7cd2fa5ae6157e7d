// [average] or [disk] for several radii from one walk of the tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "filter/engine/packets.h"
#include "filter/problem.h"

namespace psf::filter::engine {

class RingEngine {
 public:
  // The radii of record i are float(scale * basis[i]), as of radius.h; problem.radius is the
  // largest one. `scales`: ascending, distinct. All borrowed.
  RingEngine(const Problem& problem, std::span<const double> scales, std::span<const double> basis)
      : p_(problem), scales_(scales), basis_(basis), packets_(problem) {}

  // What a query is given for every scale, ascending; valid during a call.
  struct Results {
    std::uint32_t query;  // record number
    std::span<const Rgb> average;
    std::span<const std::uint32_t> neighbors;  // sources averaged; 0 for an orphan
    // (scales, 4): red, green and blue that `average` is made of, in double; then of no use.
    std::span<const double> sums;
  };

  // Where it is not, nothing else may be asked.
  [[nodiscard]] bool is_moderate() const { return packets_.is_moderate(); }
  [[nodiscard]] std::span<const std::uint32_t> queries() const { return packets_.order(); }
  // r_i of record i for a scale.
  [[nodiscard]] float radius(std::uint32_t i, std::size_t scale) const {
    return static_cast<float>(scales_[scale] * basis_[i]);
  }
  // values[j] of every source, by record number; before average().
  void set_values(std::span<const Rgb> values);

  // Visits queries [begin, end) of queries() in this order, begin a multiple of kGrain, at most
  // kGrain of them. Adds to statistics[k] of scale k what is counted of queries.
  static constexpr std::size_t kGrain = Packets::kGrain;
  void average(std::size_t begin, std::size_t end, std::span<Statistics> statistics,
               const std::function<void(const Results&)>& visit) const;

 private:
  class Range;

  const Problem& p_;
  std::span<const double> scales_, basis_;
  std::span<const Rgb> values_;
  Packets packets_;
};

}  // namespace psf::filter::engine
