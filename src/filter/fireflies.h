// [fireflies]: contributions far brighter than what is around them. A mean smears each into a blob of
// the ball's size; here they are given out over a distance of their own, or dimmed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "filter/problem.h"
#include "filter/receivers.h"
#include "filter/scaled.h"

namespace psf::filter {

// A firefly j, for those who look at them one by one.
struct Firefly {
  std::uint32_t record = 0;
  float luminance = 0;    // Y_j
  double ordinary = 0;    // m_j
  float kept = 1;         // p_j
  float reach = 0;        // R_j; 0 where nothing is given
  double per_source = 0;  // 1 / N_j; 0 where nothing is given
};

class Fireflies {
 public:
  // Finds the fireflies among the sources, as problem.radius and the weights see them, and whom they
  // give what they do not keep, where parameters.fireflies says so. `values`, by record number: what
  // is averaged. `engine` is of `problem`. `n`: that of the block. Throws Error{interrupted} on ^C.
  Fireflies(const Problem& problem, Engine& engine, std::span<const Rgb> values,
            const Parameters& parameters, double n);

  // Their record numbers, in a compact order.
  [[nodiscard]] std::span<const std::uint32_t> records() const { return records_; }

  // The g-th of them.
  [[nodiscard]] Firefly operator[](std::size_t g) const;
  // Turns R_j from the unit of `scaled` into world units.
  void to_world(const Scaled& scaled);

  // p_j by record number: the share of a source's value that is averaged like any other, in [0, 1].
  // It is below 1 for fireflies, and 1 for every other record.
  [[nodiscard]] std::span<const float> kept() const { return kept_; }
  // Whether what is not kept is given away; otherwise it is lost.
  [[nodiscard]] bool gives() const { return !first_.empty(); }
  // Sets out[i], of every record i, to what it is given: the sum over the fireflies j that reach it of
  // (1 - p_j) v_j / N_j. `values`, by record number: v.
  void give(std::span<const Rgb> values, std::span<Rgb> out) const;
  // Calls visit(j, share) for every firefly j that gives to record i; share: (1 - p_j) / N_j.
  template <typename Visit>
  void each_giver(std::uint32_t i, const Visit& visit) const {
    if (!gives()) return;
    for (std::uint64_t k = first_[i]; k < first_[i + 1]; ++k) {
      const std::uint32_t j = records_[givers_[k]];
      visit(j, (1 - double{kept_[j]}) * shares_[givers_[k]]);
    }
  }

  void add_to(Statistics& statistics) const;

 private:
  void find(const Problem& problem, std::span<const Rgb> values, std::span<const Rgb> roots,
            const FireflyRule& rule, double n);
  void find_receivers(const Problem& problem, EngineKind engine);
  // Leaves out what has no receivers: there the bright are even, and nothing is a firefly.
  void keep_even(Receivers& found);

  std::vector<float> kept_;
  std::vector<std::uint32_t> records_;
  // Of these. Reaches only where they give.
  std::vector<float> luminance_, reach_;
  std::vector<double> ordinary_;
  double light_apart_ = 0, light_ = 0;  // luminance of all sources: what is not kept, and all

  // By record number: the givers of i are givers_[first_[i]] up to givers_[first_[i + 1]], places
  // in records_.
  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> givers_;
  std::vector<double> shares_;  // 1 / N_j, by place in records_
};

}  // namespace psf::filter
