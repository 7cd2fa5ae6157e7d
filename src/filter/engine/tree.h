// The sources in a compact order, in groups of 16 and groups of groups, with bounds and sums: what
// the kernel walks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/buffer.h"
#include "filter/engine/columns.h"
#include "filter/records.h"
#include "search/box_index.h"

namespace psf::filter::engine {

// What bounds are kept for. Siblings are adjacent: node k of a level is in place k % 16 of family
// k / 16, and the groups of parent p are family p.
enum LevelName : std::size_t {
  kQuads,    // 4 records, bounds of x alone
  kGroups,   // 16 records, bounds of every column
  kParents,  // 16 groups, bounds of every column
  kLevels
};
inline constexpr std::size_t kRecordsBelow[kLevels] = {4, kWidth, kWidth* kWidth};

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
  [[nodiscard]] std::size_t nodes(LevelName level) const { return levels_[level].nodes; }
  // Records below a node.
  [[nodiscard]] std::size_t size_of(LevelName level, std::size_t node) const {
    return std::min(kRecordsBelow[level], size() - node * kRecordsBelow[level]);
  }
  // (columns, 16) least values of a family's nodes, and behind them as many greatest.
  [[nodiscard]] const float* bounds(LevelName level, std::size_t family) const {
    return &levels_[level].bounds[family * 2 * columns(level) * kWidth];
  }
  // Of every column that is neither a distance to a hit nor a width nor an integer: abs(value) <=
  // largest.
  [[nodiscard]] bool all_within(float largest) const;
  [[nodiscard]] std::size_t columns(LevelName level) const {
    return level == kQuads ? 3 : plan_.count;
  }
  [[nodiscard]] search::Box box(LevelName level, std::size_t node) const;
  // (3, 16) sums of a family's nodes.
  [[nodiscard]] const double* sums(LevelName level, std::size_t family) const {
    return &levels_[level].sums[family * 3 * kWidth];
  }

 private:
  struct Level {
    core::Buffer<float> bounds;  // (families, 2, columns, 16); repeated beyond the last node
    core::Buffer<double> sums;   // (families, 3, 16), each added up in the order of what is below
    std::size_t nodes = 0;
  };

  void bound_quads(std::size_t group);
  void bound_group(std::size_t group);
  void bound_parent(std::size_t parent);
  // Repeats the last node's bounds in the places of its family behind it.
  void fill_last_family(LevelName level);
  void sum_parent(std::size_t parent);

  ColumnPlan plan_;
  std::vector<std::uint32_t> order_;
  core::Buffer<float> leaves_;   // (groups, columns, 16)
  core::Buffer<double> values_;  // (groups, 3, 16); 0 beyond the last record
  Level levels_[kLevels];
};

}  // namespace psf::filter::engine
