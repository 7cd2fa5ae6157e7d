// The way of a ray through the cells of a density, one after another (Amanatides and Woo 1987).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/light/integrator.h"
#include "render/scene/density_grid.h"

namespace psf::render {

// Stands on a stretch of the ray that lies in one cell. Places are calculated in double, so that far
// from the ray's origin too they are in the cell that the walk has come to.
class DensityWalk {
 public:
  DensityWalk(const DensityGrid& grid, const Ray& ray, float reach)
      : grid_(grid), origin_(Imath::V3d(ray.origin) * grid.to_cells()), end_(double{reach}) {
    grid.to_cells().multDirMatrix(Imath::V3d(ray.direction), direction_);
    for (int axis = 0; axis < 3; ++axis) clip(axis);
    if (!(to_ < end_)) return;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = std::floor(origin_[axis] + to_ * direction_[axis]);
      cell_[axis] = static_cast<int>(std::max(0.0, std::min(at, grid.size()[axis] - 1.0)));
      set_exit(axis);
    }
    more_ = true;
  }

  // Goes on to the next stretch where there is anything; false where there is none.
  bool next() {
    while (more_) {
      if (standing_ && !leave()) return false;
      standing_ = true;
      from_ = to_;
      to_ = std::clamp(std::min({exit_[0], exit_[1], exit_[2]}), from_, end_);
      here_ = &grid_.cell(cell_);
      if (here_->most > 0) return true;
    }
    return false;
  }
  [[nodiscard]] double from() const { return from_; }  // distances along the ray
  [[nodiscard]] double to() const { return to_; }
  [[nodiscard]] float most() const { return here_->most; }
  // The density at a distance on this stretch.
  [[nodiscard]] float density(double distance) const {
    return DensityGrid::density(*here_, Vec3(origin_ + direction_ * distance - Imath::V3d(cell_)));
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // Takes away what of the ray is outside of the grid.
  void clip(int axis) {
    const double size = grid_.size()[axis];
    if (direction_[axis] == 0) {
      if (!(origin_[axis] >= 0 && origin_[axis] <= size)) end_ = -1;
      return;
    }
    const double low = -origin_[axis] / direction_[axis];
    const double high = (size - origin_[axis]) / direction_[axis];
    to_ = std::max(to_, std::min(low, high));
    end_ = std::min(end_, std::max(low, high));
  }
  void set_exit(int axis) {
    const double d = direction_[axis];
    exit_[static_cast<std::size_t>(axis)] =
        d == 0 ? kNever : (cell_[axis] + (d > 0 ? 1 : 0) - origin_[axis]) / d;
  }
  bool leave() {
    const auto nearest = std::min_element(exit_.begin(), exit_.end());
    const int axis = static_cast<int>(nearest - exit_.begin());
    cell_[axis] += direction_[axis] > 0 ? 1 : -1;
    more_ = to_ < end_ && cell_[axis] >= 0 && cell_[axis] < grid_.size()[axis];
    if (more_) set_exit(axis);
    return more_;
  }

  const DensityGrid& grid_;
  Imath::V3d origin_, direction_{0, 0, 0};
  Imath::V3i cell_{0, 0, 0};
  std::array<double, 3> exit_{};
  double from_ = 0, to_ = 0, end_;
  const DensityGrid::Cell* here_ = nullptr;
  bool more_ = false, standing_ = false;
};

}  // namespace psf::render
