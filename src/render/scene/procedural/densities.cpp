// Densities that are grown from a seed.
#include "render/scene/procedural/densities.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "render/scene/procedural/noise.h"

namespace psf::render {
namespace {

// Octaves of noise, each twice as fine as the one before and half as strong; their weights sum to 1.
template <class Shape>
double octaves(const Noise& noise, const Imath::V3d& p, std::uint32_t count, Shape shape) {
  double sum = 0, weight = 1, weights = 0, scale = 1;
  for (std::uint32_t k = 0; k < count; ++k) {
    sum += weight * shape(noise(p * scale + Imath::V3d(17.3 * k)));
    weights += weight;
    weight /= 2;
    scale *= 2;
  }
  return sum / weights;
}

// `density` on a lattice over `box`.
std::shared_ptr<const DensityGrid> on_lattice(
    const Imath::Box3d& box, std::uint32_t voxels, const Imath::M44d& to_space,
    const std::function<double(const Imath::V3d&)>& density) {
  constexpr int kCell = DensityGrid::kCell;
  const Imath::V3d size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  Imath::V3i cells;
  Imath::V3d step;
  for (int axis = 0; axis < 3; ++axis) {
    cells[axis] = std::max(1, static_cast<int>(std::lround(size[axis] / longest * voxels / kCell)));
    step[axis] = size[axis] / (cells[axis] * kCell);
  }
  const Imath::M44d to_scene = Imath::M44d().setScale(step) * Imath::M44d().setTranslation(box.min);
  return std::make_shared<const DensityGrid>(
      cells, to_scene * to_space, [&](const Imath::V3i& first, DensityGrid::Values& values) {
        constexpr int kSide = DensityGrid::kSide;
        std::size_t at = 0;
        for (int k = 0; k < kSide * kSide * kSide; ++k) {
          const Imath::V3i p = first + Imath::V3i(k % kSide, k / kSide % kSide, k / kSide / kSide);
          const double value = density(box.min + Imath::V3d(p) * step);
          values[at++] = static_cast<float>(std::clamp(value, 0.0, 1.0));
        }
      });
}

}  // namespace

std::shared_ptr<const DensityGrid> make_cloud(const CloudDensity& cloud,
                                              const Imath::M44d& to_space) {
  constexpr double kFlat = 2.5;  // how many times nearer the surface is below the middle
  // Noise is seldom above, in absolute value.
  constexpr double kHighest = 0.7;
  const Noise noise(cloud.seed);
  const Imath::V3d corner(cloud.radius);
  Imath::Box3d box(-corner, corner);
  box.min.y /= kFlat;
  return on_lattice(box, cloud.voxels, to_space, [&](const Imath::V3d& p) {
    const Imath::V3d q = p / cloud.radius;
    const double inside = 1 - Imath::V3d(q.x, q.y < 0 ? q.y * kFlat : q.y, q.z).length();
    if (inside <= 0) return 0.0;
    // Round backs with sharp valleys between them.
    const double height = octaves(noise, q * cloud.frequency, cloud.octaves,
                                  [](double n) { return std::min(1.0, std::abs(n) / kHighest); });
    return (inside - cloud.amplitude * (1 - height)) / cloud.edge;
  });
}

std::shared_ptr<const DensityGrid> make_mist(const MistDensity& mist, const Imath::M44d& to_space) {
  const Noise noise(mist.seed);
  const double low = mist.box.min.y, height = mist.box.max.y - mist.box.min.y;
  return on_lattice(mist.box, mist.voxels, to_space, [&](const Imath::V3d& p) {
    const double layer = 1 - (p.y - low) / height;
    if (mist.amplitude == 0) return layer;
    const double n = octaves(noise, p * mist.frequency, mist.octaves, [](double v) { return v; });
    // Noise is mostly within half of its range.
    return layer * (1 - mist.amplitude * std::clamp(0.5 - n, 0.0, 1.0));
  });
}

}  // namespace psf::render
