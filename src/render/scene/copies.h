// Adds the copies of a mesh to a scene: as one mesh, or as instances of one.
#pragma once

#include <ImathBox.h>

#include <cstddef>
#include <span>

#include "render/scene/scene.h"

namespace psf::render {

// The most instances of one shape; more copies are one mesh.
constexpr std::size_t kMaxInstances = std::size_t{1} << 20;

// Whether the copies of `mesh`, whose material is in the scene, become instances: where as one mesh
// they would have at least 2^16 triangles, and the shape has at least 16, whose memory is that of
// some instances. Lights stay meshes, whose triangles are sampled; so do copies whose sizes are too
// far apart for floats.
[[nodiscard]] bool is_instanced(const Scene& scene, const Mesh& mesh,
                                std::span<const Imath::M44d> placements);

// Adds a copy of `mesh` at each of `placements`, for row vectors. `exact`: positions are computed
// in double, else placements are rounded to float first. `instanced`: as instances. Throws
// Error{bad_input} for a placement without inverse.
void add_copies(Scene& scene, const Mesh& mesh, std::span<const Imath::M44d> placements, bool exact,
                bool instanced);

// The box around a prototype, and that around the eight corners of a prototype's box where an
// instance places them.
[[nodiscard]] Imath::Box3d bounds_of(const Mesh& prototype);
[[nodiscard]] Imath::Box3d bounds_of(const Imath::Box3d& prototype, const Instance& instance);

}  // namespace psf::render
