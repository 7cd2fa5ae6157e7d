// The sources in a compact order, in groups of 16 and groups of groups, with bounds and sums: what
// the kernel walks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/buffer.h"
#include "filter/engine/columns.h"
#include "filter/records.h"
#include "search/box_index.h"

namespace psf::filter::engine {

// Levels of bounds above the records: groups of 16, and groups of groups of 256.
inline constexpr std::size_t kLevels = 2;

// Bounds and tests use the operations of the truth (ball.h, weights.h) in its order. Rounding is
// monotone, so the same operations on the least and the greatest operand enclose, to the last bit,
// every result below a node: no margin, and no pair that bounds and test would judge differently.
class Tree {
 public:
  // `order`: the sources' record numbers in a compact order.
  Tree(const Records& records, std::vector<std::uint32_t> order, const ColumnPlan& plan);

  // values[j] of every source, times area[j] unless empty; both by record number.
  void set_values(std::span<const Rgb> values, std::span<const float> area);

  [[nodiscard]] std::size_t size() const { return order_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  [[nodiscard]] const ColumnPlan& plan() const { return plan_; }
  // (columns, 16) of group g.
  [[nodiscard]] const float* group(std::size_t g) const {
    return &leaves_[g * plan_.count * kWidth];
  }
  // (3, 16) of group g.
  [[nodiscard]] const double* values(std::size_t g) const { return &values_[g * 3 * kWidth]; }
  // Level 0: groups of records; level 1: groups of groups.
  [[nodiscard]] std::size_t nodes(std::size_t level) const { return levels_[level].nodes; }
  // (columns, 16) least values of a family's nodes, and behind them as many greatest.
  [[nodiscard]] const float* bounds(std::size_t level, std::size_t family) const {
    return &levels_[level].bounds[family * 2 * plan_.count * kWidth];
  }
  [[nodiscard]] search::Box box(std::size_t level, std::size_t node) const;
  // (3, 16) sums of a family's nodes.
  [[nodiscard]] const double* sums(std::size_t level, std::size_t family) const {
    return &levels_[level].sums[family * 3 * kWidth];
  }

 private:
  void bound_family(std::size_t level, std::size_t family);
  void sum_family(std::size_t level, std::size_t family);

  // Families of kWidth siblings: node k in place k % 16 of family k / 16.
  struct Level {
    core::Buffer<float> bounds;  // (families, 2, columns, 16)
    core::Buffer<double> sums;   // (families, 3, 16), each added up in the order of its children
    std::size_t nodes = 0;
  };

  ColumnPlan plan_;
  std::vector<std::uint32_t> order_;
  core::Buffer<float> leaves_;   // (groups, columns, 16)
  core::Buffer<double> values_;  // (groups, 3, 16); 0 beyond the last record
  Level levels_[kLevels];
};

}  // namespace psf::filter::engine
