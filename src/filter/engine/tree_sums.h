// What the kernel adds up: a value of every source of a tree, and the sums below its nodes.
#pragma once

#include <cstddef>
#include <span>

#include "core/buffer.h"
#include "core/vec.h"
#include "filter/engine/tree.h"

namespace psf::filter::engine {

class TreeSums {
 public:
  // The values are values[j], times area[j] unless `area` is empty; both are indexed by record
  // number. The tree is borrowed.
  TreeSums(const Tree& tree, std::span<const Rgb> values, std::span<const float> area);

  // The values of group g, (3, 16); 0 beyond the last record.
  [[nodiscard]] const double* values(std::size_t g) const { return &values_[g * 3 * kWidth]; }
  // The sums of the values below each of a family's nodes, (3, 16).
  [[nodiscard]] const double* below(LevelName level, std::size_t family) const {
    return &sums_[level][family * 3 * kWidth];
  }

 private:
  void add_up(const Tree& tree, std::size_t parent);

  core::Buffer<double> values_;         // (groups, 3, 16)
  core::Buffer<double> sums_[kLevels];  // (families, 3, 16), in the order of the nodes below
};

}  // namespace psf::filter::engine
