// Densities of media from OpenVDB files.
#pragma once

#include <memory>
#include <string>

#include "core/vec.h"
#include "render/scene/density_grid.h"

namespace psf::render {

// Reads the grid of floats that is called `grid`: values at voxels' places, trilinear between them.
// `to_space` takes the file's world into the scene's space. Throws Error{io} where the file is
// missing, Error{limit} where its voxels are too far apart, and Error{bad_input} where it is no VDB
// file or is damaged, has no such grid, the grid is not of floats or is a level set, a value is not
// finite or below 0, or it is not 0 outside. All errors name the file. Without OpenVDB
// (PSF_BUILD_VDB) it throws Error{bad_input} for any file.
[[nodiscard]] std::shared_ptr<const DensityGrid> read_vdb(const std::string& path,
                                                          const std::string& grid,
                                                          const Imath::M44d& to_space);

}  // namespace psf::render
