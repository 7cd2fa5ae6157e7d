// Whether one query refuses every source below a node of the tree, by the node's bounds.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>

#include "filter/engine/tree.h"
#include "filter/problem.h"

namespace psf::filter::engine {

// Of the terms whose bounds a single query can test quickly; the others refuse no node. As in the
// kernel, rounding is monotone, so what is refused here is refused pair by pair.
class Refusal {
 public:
  Refusal(const Tree& tree, const Problem& problem, std::uint32_t i)
      : tree_(tree), r_(problem.records), on_(problem.weights.terms()), i_(i) {}

  // `level`: kGroups or kParents.
  [[nodiscard]] bool refuses(LevelName level, std::size_t node) const {
    const ColumnPlan& plan = tree_.plan();
    const Bounds of = {tree_.bounds(level, node / kWidth) + node % kWidth, plan.count};
    return (on_.visibility && of.apart(*plan.visibility, r_.visibility[i_])) ||
           (on_.material && of.apart(*plan.material, r_.material[i_])) ||
           (on_.normal && of.most_along(*plan.normal, r_.normal[i_]) < *on_.normal) ||
           (on_.reflectance && of.gap_sq(*plan.reflectance, r_.reflectance[i_]) >
                                   *on_.reflectance * *on_.reflectance) ||
           (on_.direction && of.most_along(*plan.direction, r_.direction[i_]) < *on_.direction);
  }

 private:
  struct Bounds {
    const float* least;
    std::size_t columns;

    [[nodiscard]] float low(std::size_t c) const { return least[c * kWidth]; }
    [[nodiscard]] float high(std::size_t c) const { return least[(columns + c) * kWidth]; }
    [[nodiscard]] Vec3 lows(std::size_t c) const { return {low(c), low(c + 1), low(c + 2)}; }
    [[nodiscard]] Vec3 highs(std::size_t c) const { return {high(c), high(c + 1), high(c + 2)}; }

    // Whether no integer of the column is `value`.
    [[nodiscard]] bool apart(std::size_t c, std::uint32_t value) const {
      const auto of = [](float bits) { return std::bit_cast<std::int32_t>(bits); };
      const auto v = static_cast<std::int32_t>(value);
      return v < of(low(c)) || v > of(high(c));
    }
    // The greatest inner product with v.
    [[nodiscard]] float most_along(std::size_t c, const Vec3& v) const {
      const Vec3 a = lows(c), b = highs(c);
      return dot(v, Vec3(v.x < 0 ? a.x : b.x, v.y < 0 ? a.y : b.y, v.z < 0 ? a.z : b.z));
    }
    // The least squared distance from v.
    [[nodiscard]] float gap_sq(std::size_t c, const Vec3& v) const {
      return search::gap_sq({v, v}, {lows(c), highs(c)});
    }
  };

  const Tree& tree_;
  const Records& r_;
  const WeightTerms& on_;
  std::uint32_t i_;
};

}  // namespace psf::filter::engine
