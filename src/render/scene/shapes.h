// Makes meshes from a few numbers (quads, boxes, lathed profiles, arches), and transforms and joins
// meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "render/scene/scene.h"

namespace psf::render {

// All meshes have uvs, and their front is outside. Lengths are in scene units.

// Corners origin, origin + u, origin + u + v, origin + v with uv (0,0), (1,0), (1,1), (0,1); front
// along u x v.
[[nodiscard]] Mesh make_quad(const Vec3& origin, const Vec3& u, const Vec3& v);
// An axis-aligned box; uv is [0, 1]^2 on each face.
[[nodiscard]] Mesh make_box(const Vec3& min, const Vec3& max);
// Turns a profile of points (radius, y) about the y axis. The front is outside where y grows from
// point to point, so solid bodies list their profile from bottom to top. u goes around the axis, v
// along the profile. The mesh is smooth around the axis and has an edge at each point of the
// profile. A radius of 0 closes an end.
[[nodiscard]] Mesh make_lathe(std::span<const Vec2> profile, std::uint32_t segments);
// A cylinder or cone from `from` to `to`, with end disks if `caps` is set.
[[nodiscard]] Mesh make_cylinder(const Vec3& from, const Vec3& to, float from_radius,
                                 float to_radius, std::uint32_t segments, bool caps);

struct Arch {
  // Size of the panel, which is centred on x = 0 and z = 0 and begins at y = 0.
  float width = 2, height = 1.5f, depth = 0.5f;
  float span = 1.6f;  // width of the opening at y = 0, at most `width`
  float rise = 0.8f;  // height of the opening at x = 0, less than `height`
  std::uint32_t segments = 24;
};
// A panel with an elliptic opening cut from its bottom. On its faces uv is (x, y), in scene units.
[[nodiscard]] Mesh make_arch(const Arch& arch);

// Transforms positions and tangents by `m` (row vectors, p * m), normals by its inverse transposed. Where m
// mirrors, the winding is reversed, so the front stays the front. Throws Error{bad_input} where m
// has no inverse.
void transform(Mesh& mesh, const Mat4& m);
// The same in double; the result is rounded to float once.
void transform(Mesh& mesh, const Imath::M44d& m);
void flip(Mesh& mesh);  // front becomes back
// A unit normal for each vertex: of the triangles around it, by their areas. A vertex of no triangle
// needs none, and has that up.
[[nodiscard]] std::vector<Vec3> smooth_normals(const Mesh& mesh);
// Adds the triangles of `part`; both have normals, or neither; so too for uvs and tangents.
void append(Mesh& mesh, const Mesh& part);

}  // namespace psf::render
