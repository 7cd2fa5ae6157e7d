// [average] or [disk] for several radii from one walk of the tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "filter/engine/packets.h"
#include "filter/problem.h"

namespace psf::filter::engine {

class RingEngine {
 public:
  // The radii of record i are float(scale * basis[i]) for each of `scales`, as in radius.h;
  // problem.radius holds the largest. `scales` are ascending and distinct. All arguments are
  // borrowed.
  RingEngine(const Problem& problem, std::span<const double> scales, std::span<const double> basis)
      : p_(problem), scales_(scales), basis_(basis), packets_(problem) {}

  // The results of one query for every scale, in ascending order of the scales; valid during the
  // call of `visit`.
  struct Results {
    std::uint32_t query;  // record number
    std::span<const Rgb> average;
    std::span<const std::uint32_t> neighbors;  // number of sources averaged; 0 for an orphan
    // (scales, 4): the sums of red, green and blue that `average` is computed from; the fourth
    // value is of no use.
    std::span<const double> sums;
  };

  // Whether the values are small enough for the engine. Where they are not, call nothing else.
  [[nodiscard]] bool is_moderate() const { return packets_.is_moderate(); }
  [[nodiscard]] std::span<const std::uint32_t> queries() const { return packets_.order(); }
  // r_i of record i for a scale.
  [[nodiscard]] float radius(std::uint32_t i, std::size_t scale) const {
    return static_cast<float>(scales_[scale] * basis_[i]);
  }
  // Sets the values to average, by record number; only those of sources are read. Call it before
  // average().
  void set_values(std::span<const Rgb> values);

  // Calls `visit` for each query in [begin, end) of queries(), in this order. `begin` is a multiple
  // of kGrain, and the range has at most kGrain queries. Adds the counts of queries for scale k to
  // statistics[k].
  static constexpr std::size_t kGrain = Packets::kGrain;
  void average(std::size_t begin, std::size_t end, std::span<Statistics> statistics,
               const std::function<void(const Results&)>& visit) const;

 private:
  class Range;

  const Problem& p_;
  std::span<const double> scales_, basis_;
  std::span<const Rgb> values_;
  Packets packets_;
  std::optional<TreeSums> sums_;
};

}  // namespace psf::filter::engine
