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

class Fireflies {
 public:
  // Finds the fireflies among the sources, as problem.radius and the weights see them, and whom they
  // give what they do not keep, where parameters.fireflies says so. `values`, by record number: what
  // is averaged. `engine` is of `problem`. `n`: that of the block. Throws Error{interrupted} on ^C.
  Fireflies(const Problem& problem, Engine& engine, std::span<const Rgb> values,
            const Parameters& parameters, double n);

  // In a compact order. Every other source keeps all it has.
  [[nodiscard]] std::span<const Firefly> all() const { return all_; }
  // Turns R_j from the unit of `scaled` into world units.
  void to_world(const Scaled& scaled);

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
      const Firefly& of = all_[givers_[k]];
      visit(of.record, (1 - double{of.kept}) * of.per_source);
    }
  }

  void add_to(Statistics& statistics) const;

 private:
  void find(const Problem& problem, std::span<const Rgb> values, std::span<const Rgb> roots,
            const FireflyRule& rule, double n);
  // Turns lists of receivers, one a firefly, into lists of givers, one a record.
  void turn_round(std::vector<std::vector<std::uint32_t>> receivers, std::size_t records);

  std::vector<Firefly> all_;
  double light_ = 0;  // luminance of all sources

  // By record number: the givers of i are givers_[first_[i]] up to givers_[first_[i + 1]], places
  // in all_.
  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> givers_;
};

}  // namespace psf::filter
