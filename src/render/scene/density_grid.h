// How dense a medium is from place to place: values on a lattice, in cells that know their largest.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/vec.h"

namespace psf::render {

// The density is a number >= 0 that multiplies a medium's coefficients. It is trilinear between the
// points of a lattice and 0 outside of the cells, which are cubes of kCell steps of the lattice. A
// cell keeps its own points, those that it shares with others too, so that one look-up reads one cell.
class DensityGrid {
 public:
  static constexpr int kCell = 8;
  static constexpr int kSide = kCell + 1;  // points of a cell along each axis
  using Values = std::array<float, std::size_t{kSide} * kSide * kSide>;  // x fastest, then y
  // Sets the values of the cell whose first point is `first`, all finite and >= 0. Several threads
  // call it at once.
  using Fill = std::function<void(const Imath::V3i& first, Values& values)>;

  struct Cell {
    float most = 0;                        // the largest of its values
    std::unique_ptr<const Values> values;  // null: it is `most` everywhere
  };

  // The largest number of cells.
  static constexpr std::size_t kMaxCells = std::size_t{1} << 24;
  // Throws Error{limit} that begins with `name` where there would be more than kMaxCells, or none.
  static void check_count(const Imath::V3i& cells, const std::string& name);

  // `to_space` takes points of the lattice, the first of which is (0, 0, 0), into the scene's space, as
  // row vectors.
  DensityGrid(const Imath::V3i& cells, const Imath::M44d& to_space, const Fill& fill);

  [[nodiscard]] const Imath::V3i& size() const { return size_; }  // in cells
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] const Cell& cell(const Imath::V3i& at) const {
    return cells_[static_cast<std::size_t>(at.x) +
                  static_cast<std::size_t>(size_.x) *
                      (static_cast<std::size_t>(at.y) +
                       static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(at.z))];
  }
  // From the scene's space to cells: the cell of number (i, j, k) lies from (i, j, k) to
  // (i + 1, j + 1, k + 1).
  [[nodiscard]] const Imath::M44d& to_cells() const { return to_cells_; }
  [[nodiscard]] float most() const { return most_; }

  // The density in a cell, at `within` from its first point to its last, (0, 0, 0) to (1, 1, 1).
  [[nodiscard]] static float density(const Cell& cell, const Vec3& within);

 private:
  Imath::V3i size_;
  Imath::M44d to_cells_;
  std::vector<Cell> cells_;
  float most_ = 0;
};

inline float DensityGrid::density(const Cell& cell, const Vec3& within) {
  if (cell.values == nullptr) return cell.most;
  int first[3];
  float share[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float at = std::min(std::max(within[axis], 0.0f), 1.0f) * kCell;
    first[axis] = std::min(static_cast<int>(at), kCell - 1);
    share[axis] = at - static_cast<float>(first[axis]);
  }
  const int at = first[0] + kSide * (first[1] + kSide * first[2]);
  const float* v = cell.values->data() + at;
  const auto mix = [](float a, float b, float t) { return a + (b - a) * t; };
  constexpr int kY = kSide, kZ = kSide * kSide;
  const float low = mix(mix(v[0], v[1], share[0]), mix(v[kY], v[kY + 1], share[0]), share[1]);
  const float high =
      mix(mix(v[kZ], v[kZ + 1], share[0]), mix(v[kZ + kY], v[kZ + kY + 1], share[0]), share[1]);
  return mix(low, high, share[2]);
}

}  // namespace psf::render
