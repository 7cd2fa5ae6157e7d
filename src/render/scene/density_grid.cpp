// Making the cells of a density.
#include "render/scene/density_grid.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/parallel.h"

namespace psf::render {

void DensityGrid::check_count(const Imath::V3i& cells, const std::string& name) {
  std::size_t count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto along = static_cast<std::size_t>(std::max(cells[axis], 0));
    if (along > kMaxCells / std::max<std::size_t>(count, 1)) {
      throw Error(ErrorCode::limit,
                  fmt::format("{}: has more than {} cells of {} voxels a side; make it coarser",
                              name, kMaxCells, kCell));
    }
    count *= along;
  }
}

DensityGrid::DensityGrid(const Imath::V3i& cells, const Imath::M44d& to_space, const Fill& fill)
    : size_(cells),
      to_cells_(to_space.inverse() * Imath::M44d().setScale(1.0 / kCell)),
      cells_(static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y) *
             static_cast<std::size_t>(cells.z)) {
  const auto columns = static_cast<std::size_t>(cells.x), rows = static_cast<std::size_t>(cells.y);
  core::parallel_for(cells_.size(), 64, [&](std::size_t begin, std::size_t end) {
    Values values;
    for (std::size_t c = begin; c < end; ++c) {
      const Imath::V3i at(static_cast<int>(c % columns), static_cast<int>(c / columns % rows),
                          static_cast<int>(c / (columns * rows)));
      fill(at * kCell, values);
      const auto [least, most] = std::minmax_element(values.begin(), values.end());
      cells_[c].most = *most;
      if (*least < *most) cells_[c].values = std::make_unique<const Values>(values);
    }
  });
  for (const Cell& cell : cells_) most_ = std::max(most_, cell.most);
}

}  // namespace psf::render
