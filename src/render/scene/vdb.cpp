// Densities of media from OpenVDB files. The only file that includes OpenVDB.
#include "render/scene/vdb.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <filesystem>
#include <new>
#include <vector>

#include "core/error.h"

namespace psf::render {
namespace {

using openvdb::FloatGrid;

[[noreturn]] void fail(const std::string& path, const std::string& problem) {
  throw Error(ErrorCode::bad_input, path + ": " + problem);
}

// What OpenVDB throws, as one line.
template <class Read>
auto reading(const std::string& path, Read read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
    // Of a file that is cut off OpenVDB reads counts that are there by chance.
    fail(path, "damaged, or too large for the memory");
  } catch (const std::exception& error) {
    fail(path, fmt::format("not a VDB file, or damaged ({})", error.what()));
  }
}

// Looks at its kind before any of its values is read.
FloatGrid::ConstPtr read_floats(const std::string& path, const std::string& name) {
  openvdb::initialize();
  openvdb::io::File file(path);
  reading(path, [&] { file.open(false); });
  if (!file.hasGrid(name)) {
    std::vector<std::string> names;
    for (auto at = file.beginName(); at != file.endName(); ++at) names.push_back(at.gridName());
    fail(path, names.empty() ? "has no grid"
                             : fmt::format("no grid is called \"{}\"; it has {}", name,
                                           fmt::join(names, ", ")));
  }
  const openvdb::GridBase::ConstPtr kind =
      reading(path, [&] { return file.readGridMetadata(name); });
  const std::string of_grid = fmt::format("grid {}: ", name);
  if (!kind->isType<FloatGrid>()) {
    fail(path, fmt::format("{}has values of the type {}; a density is one of floats", of_grid,
                           kind->valueType()));
  }
  if (kind->getGridClass() == openvdb::GRID_LEVEL_SET) {
    fail(path, of_grid + "is a level set, which has distances; store it as a fog volume");
  }
  if (!kind->transform().isLinear()) {
    fail(path, of_grid + "lies in the frustum of a camera; resample it onto an even grid");
  }
  const auto grid = reading(path, [&] { return file.readGrid(name); });
  return openvdb::gridConstPtrCast<FloatGrid>(grid);
}

void check_values(const std::string& path, const std::string& name, const FloatGrid& grid) {
  if (grid.background() != 0) {
    fail(path, fmt::format("grid {}: its background is {}; outside of its voxels there must be 0",
                           name, grid.background()));
  }
  for (auto at = grid.cbeginValueAll(); at; ++at) {
    const float value = *at;
    if (value >= 0 && std::isfinite(value)) continue;
    const openvdb::Coord voxel = at.getCoord();
    fail(path, fmt::format("grid {}: voxel {}, {}, {}: a density is a finite number >= 0, not {}",
                           name, voxel.x(), voxel.y(), voxel.z(), value));
  }
}

// From voxels to the file's world; both libraries multiply row vectors.
Imath::M44d voxels_to_world(const std::string& path, const std::string& name,
                            const FloatGrid& grid) {
  const openvdb::Mat4R from = grid.transform().baseMap()->getAffineMap()->getMat4();
  Imath::M44d to;
  bool finite = true;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      to[row][column] = from(row, column);
      finite = finite && std::isfinite(to[row][column]);
    }
  }
  if (!finite || !(std::abs(to.determinant()) > 0)) {
    fail(path, fmt::format("grid {}: its transform makes everything flat", name));
  }
  return to;
}

// Copies the values from `first` on, which is the first voxel of a leaf of the tree. A leaf has
// kCell voxels a side, and what is in no leaf is the same over at least as much.
void copy(const FloatGrid& grid, const openvdb::Coord& first, DensityGrid::Values& values) {
  constexpr int kCell = DensityGrid::kCell, kSide = DensityGrid::kSide;
  static_assert(FloatGrid::TreeType::LeafNodeType::DIM == kCell);
  const auto tree = grid.getConstUnsafeAccessor();
  for (int part = 0; part < 8; ++part) {
    const openvdb::Coord low(part & 1 ? kCell : 0, part & 2 ? kCell : 0, part & 4 ? kCell : 0);
    const openvdb::Coord high(part & 1 ? kSide : kCell, part & 2 ? kSide : kCell,
                              part & 4 ? kSide : kCell);
    const auto* leaf = tree.probeConstLeaf(first + low);
    const float outside = leaf == nullptr ? tree.getValue(first + low) : 0;
    for (int z = low.z(); z < high.z(); ++z) {
      for (int y = low.y(); y < high.y(); ++y) {
        for (int x = low.x(); x < high.x(); ++x) {
          values[static_cast<std::size_t>(x + kSide * (y + kSide * z))] =
              leaf == nullptr ? outside : leaf->getValue(first + openvdb::Coord(x, y, z));
        }
      }
    }
  }
}

}  // namespace

std::shared_ptr<const DensityGrid> read_vdb(const std::string& path, const std::string& name,
                                            const Imath::M44d& to_space) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw Error(ErrorCode::io, path + ": no such file");
  const FloatGrid::ConstPtr grid = read_floats(path, name);
  check_values(path, name, *grid);
  const Imath::M44d to_world = voxels_to_world(path, name, *grid);
  const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
  if (box.empty()) fail(path, fmt::format("grid {}: has no active voxel", name));
  // The density goes down to 0 from the outermost voxels to the next ones.
  constexpr int kCell = DensityGrid::kCell;
  Imath::V3i first, cells;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell_of = [](std::int64_t voxel) { return static_cast<int>(voxel >> 3); };
    const auto along = static_cast<std::size_t>(axis);
    first[axis] = cell_of(std::int64_t{box.min()[along]} - 1);
    cells[axis] = cell_of(box.max()[along]) - first[axis] + 1;
  }
  static_assert(kCell == 8);
  DensityGrid::check_count(cells, fmt::format("{}: grid {}", path, name));
  const Imath::V3i corner = first * kCell;
  Imath::M44d from_corner;
  from_corner.setTranslation(Imath::V3d(corner));
  return std::make_shared<const DensityGrid>(
      cells, from_corner * to_world * to_space,
      [&](const Imath::V3i& at, DensityGrid::Values& values) {
        const Imath::V3i voxel = corner + at;
        copy(*grid, openvdb::Coord(voxel.x, voxel.y, voxel.z), values);
      });
}

}  // namespace psf::render
