// The tree that the kernel walks: the sources in a compact order, in groups of 16 and groups of
// groups, with bounds. What is added up on the walk is in tree_sums.h.
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

// The levels of nodes for which bounds are kept. Siblings are adjacent: node k of a level is in
// place k % 16 of family k / 16, and the groups of parent p are family p.
enum LevelName : std::size_t {
  kQuads,    // 4 records, bounds of x alone
  kGroups,   // 16 records, bounds of every column
  kParents,  // 16 groups, bounds of every column
  kLevels
};
inline constexpr std::size_t kRecordsBelow[kLevels] = {4, kWidth, kWidth* kWidth};

// Bounds and tests use the operations of ball.h and weights.h in the same order. Rounding is
// monotone, so the same operations on the least and the greatest operands enclose every result
// below a node to the last bit. So no margin is needed, and bounds and tests never contradict each
// other.
class Tree {
 public:
  // `order`: the sources' record numbers in a compact order.
  Tree(const Records& records, std::vector<std::uint32_t> order, const ColumnPlan& plan);

  [[nodiscard]] std::size_t size() const { return order_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  [[nodiscard]] const ColumnPlan& plan() const { return plan_; }
  // The columns of group g, (columns, 16).
  [[nodiscard]] const float* group(std::size_t g) const {
    return &leaves_[g * plan_.count * kWidth];
  }
  [[nodiscard]] std::size_t nodes(LevelName level) const { return levels_[level].nodes; }
  // The number of records below a node.
  [[nodiscard]] std::size_t size_of(LevelName level, std::size_t node) const {
    return std::min(kRecordsBelow[level], size() - node * kRecordsBelow[level]);
  }
  // The bounds of a family's nodes, (2, columns, 16): first the least, then the greatest values.
  [[nodiscard]] const float* bounds(LevelName level, std::size_t family) const {
    return &levels_[level].bounds[family * 2 * columns(level) * kWidth];
  }
  // Whether abs(value) <= largest for every value in the columns that hold neither hit distances
  // nor lobe widths nor integers.
  [[nodiscard]] bool all_within(float largest) const;
  [[nodiscard]] std::size_t columns(LevelName level) const {
    return level == kQuads ? 3 : plan_.count;
  }
  [[nodiscard]] search::Box box(LevelName level, std::size_t node) const;

 private:
  struct Level {
    core::Buffer<float> bounds;  // (families, 2, columns, 16); the last node is repeated at the end
    std::size_t nodes = 0;
  };

  void bound_quads(std::size_t group);
  void bound_group(std::size_t group);
  void bound_parent(std::size_t parent);
  // Repeats the last node's bounds up to the end of its family.
  void fill_last_family(LevelName level);

  ColumnPlan plan_;
  std::vector<std::uint32_t> order_;
  core::Buffer<float> leaves_;  // (groups, columns, 16)
  Level levels_[kLevels];
};

}  // namespace psf::filter::engine
