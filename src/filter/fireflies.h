// [fireflies]: contributions far brighter than what is around them. A mean smears each into a blob of
// the ball's size; here they are given out over a distance of their own, or dimmed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "filter/problem.h"

namespace psf::filter {

class Fireflies {
 public:
  // Finds the fireflies among the sources, as problem.radius and the weights see them, and whom they
  // give what they do not keep, where parameters.fireflies says so. `values`, by record number: what
  // is averaged. `engine` is of `problem`. `n`: that of the block. Throws Error{interrupted} on ^C.
  Fireflies(const Problem& problem, Engine& engine, std::span<const Rgb> values,
            const Parameters& parameters, double n);

  // Their record numbers, in a compact order.
  [[nodiscard]] std::span<const std::uint32_t> records() const { return records_; }

  // p_j by record number: the share of a source's value that is averaged like any other, in [0, 1].
  // It is below 1 for fireflies, and 1 for every other record.
  [[nodiscard]] std::span<const float> kept() const { return kept_; }
  // Whether what is not kept is given away; otherwise it is lost.
  [[nodiscard]] bool gives() const { return !first_.empty(); }
  // Sets out[i], of every record i, to what it is given: the sum over the fireflies j that reach it of
  // (1 - p_j) v_j / N_j. `values`, by record number: v.
  void give(std::span<const Rgb> values, std::span<Rgb> out) const;

  void add_to(Statistics& statistics) const;

 private:
  void find(const Problem& problem, std::span<const Rgb> values, std::span<const Rgb> roots,
            const FireflyRule& rule, double n);
  // R_j of every firefly, in the order of records_.
  [[nodiscard]] std::vector<float> reaches(const Problem& problem, EngineKind engine) const;
  void find_receivers(const Problem& problem, EngineKind engine);

  std::vector<float> kept_;
  std::vector<std::uint32_t> records_;
  std::vector<float> luminance_;        // of these
  double light_apart_ = 0, light_ = 0;  // luminance of all sources: what is not kept, and all

  // By record number: the givers of i are givers_[first_[i]] up to givers_[first_[i + 1]], places
  // in records_.
  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> givers_;
  std::vector<double> inverse_;  // 1 / N_j, by place in records_
};

}  // namespace psf::filter
