// Densities of which a test knows the closed form.
#pragma once

#include <ImathBox.h>

#include <functional>

#include "render/scene/density_grid.h"

namespace psf::render::test {

// `density` at the points of a lattice of `cells` cells over `box`, as a test's own closed form.
inline std::shared_ptr<const DensityGrid> sampled_density(
    const Imath::Box3d& box, const Imath::V3i& cells,
    const std::function<double(const Imath::V3d&)>& density) {
  const Imath::V3d step = box.size() / (Imath::V3d(cells) * DensityGrid::kCell);
  const Imath::M44d to_space = Imath::M44d().setScale(step) * Imath::M44d().setTranslation(box.min);
  return std::make_shared<const DensityGrid>(
      cells, to_space, [&](const Imath::V3i& first, DensityGrid::Values& values) {
        std::size_t n = 0;
        for (int z = 0; z < DensityGrid::kSide; ++z) {
          for (int y = 0; y < DensityGrid::kSide; ++y) {
            for (int x = 0; x < DensityGrid::kSide; ++x) {
              const Imath::V3d p = box.min + Imath::V3d(first + Imath::V3i(x, y, z)) * step;
              values[n++] = static_cast<float>(density(p));
            }
          }
        }
      });
}

// The density at a place, by the cells alone.
inline double density_at(const DensityGrid& grid, const Imath::V3d& place) {
  const Imath::V3d at = place * grid.to_cells();
  Imath::V3i cell;
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = static_cast<int>(std::floor(at[axis]));
    if (cell[axis] < 0 || cell[axis] >= grid.size()[axis]) return 0;
  }
  return double{DensityGrid::density(grid.cell(cell), Vec3(at - Imath::V3d(cell)))};
}

}  // namespace psf::render::test
