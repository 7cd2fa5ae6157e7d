// Densities of media that are grown from a seed: a cloud, and mist in layers.
#pragma once

#include <ImathBox.h>

#include <cstdint>
#include <memory>

#include "core/vec.h"
#include "render/scene/density_grid.h"

namespace psf::render {

// All numbers are lengths in scene units, or parts of the whole. Values are within [0, 1], calculated
// on a lattice of about `voxels` steps along the longest side; `to_space` takes scene units into the
// scene's space. The same seed grows the same density on every machine.

struct CloudDensity {
  std::uint64_t seed = 0;
  double radius = 1;       // of the ball about the origin in which it is; it is flat below
  double frequency = 2;    // of its largest billows, per radius
  double amplitude = 0.6;  // how deep they are carved into the ball, beside the radius
  double edge = 0.15;  // how far behind the surface it is as dense as it gets, beside the radius
  std::uint32_t octaves = 5;
  std::uint32_t voxels = 64;
};
[[nodiscard]] std::shared_ptr<const DensityGrid> make_cloud(const CloudDensity& cloud,
                                                            const Imath::M44d& to_space);

// In a box: 1 at the bottom and 0 at the top, in a straight line, times noise.
struct MistDensity {
  std::uint64_t seed = 0;
  Imath::Box3d box;
  double frequency = 1;  // of its largest swathes, per scene unit
  double amplitude = 0;  // 0: without noise; 1: where there is least, there is none
  std::uint32_t octaves = 4;
  std::uint32_t voxels = 64;
};
[[nodiscard]] std::shared_ptr<const DensityGrid> make_mist(const MistDensity& mist,
                                                           const Imath::M44d& to_space);

}  // namespace psf::render
