// Meshes made from a few numbers: quads, boxes, lathed profiles, arches; and what moves and joins
// meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/vec.h"
#include "render/scene.h"

namespace psf::render {

// All have uvs; the front is outside. Lengths in scene units.

// Corners origin, origin + u, origin + u + v, origin + v with uv (0,0), (1,0), (1,1), (0,1); front
// along u x v.
[[nodiscard]] Mesh make_quad(const Vec3& origin, const Vec3& u, const Vec3& v);
// Each face has uv [0, 1]^2.
[[nodiscard]] Mesh make_box(const Vec3& min, const Vec3& max);
// Turns a profile of points (radius, y) about the y axis; outside where y grows from point to
// point, so solid bodies list their profile from bottom to top. u goes around, v along the profile.
// Smooth around the axis, with an edge at each point of the profile. radius 0 closes an end.
[[nodiscard]] Mesh make_lathe(std::span<const Vec2> profile, std::uint32_t segments);
// Cylinder or cone from `from` to `to`, with or without its end disks.
[[nodiscard]] Mesh make_cylinder(const Vec3& from, const Vec3& to, float from_radius,
                                 float to_radius, std::uint32_t segments, bool caps);

struct Arch {
  float width = 2, height = 1.5f,
        depth = 0.5f;  // of the panel: centred on x = 0 and z = 0, from y = 0 up
  float span = 1.6f;   // width of the opening at y = 0, at most `width`
  float rise = 0.8f;   // height of the opening at x = 0, less than `height`
  std::uint32_t segments = 24;
};
// A panel with an elliptic opening cut from its bottom. uv (x, y) on the faces, in scene units.
[[nodiscard]] Mesh make_arch(const Arch& arch);

// Positions by `m` (row vectors, p * m), normals by its inverse transposed; a mirroring m turns the
// winding, so the front stays the front. Throws Error{bad_input} where m has no inverse.
void transform(Mesh& mesh, const Mat4& m);
// The same in double, rounded once.
void transform(Mesh& mesh, const Imath::M44d& m);
void flip(Mesh& mesh);  // front becomes back
// Adds the triangles of `part`; both have normals, or neither; both have uvs, or neither.
void append(Mesh& mesh, const Mesh& part);

}  // namespace psf::render
