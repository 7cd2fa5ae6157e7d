// Shapes that are grown from a seed: hair, a tree, a carved ball, a tuft of grass.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "render/scene/scene.h"

namespace psf::render {

// All stand at the origin, y is up, and lengths are in scene units. The same seed grows the same
// shape on every machine.

struct StrandPoint {
  Imath::V3d position{0, 0, 0};
  double radius = 0;
};
using Strand = std::vector<StrandPoint>;

// A smooth curve through the points (Catmull and Rom 1974), as `pieces` straight ones from each
// point to the next.
[[nodiscard]] Strand smooth(const Strand& points, std::uint32_t pieces);

struct Hairball {
  std::uint64_t seed = 0;
  double radius = 1;         // of the ball with its hair
  double thickness = 0.003;  // of a strand at its root, from side to side; the tip is a point
  double curl = 0.5;         // 0: straight out
  std::uint32_t strands = 4000, segments = 24;
};
[[nodiscard]] std::vector<Strand> make_hairball(const Hairball& hairball);

struct Tree {
  std::uint64_t seed = 0;
  double height = 6;
  double leaf_size = 0.15;
  std::uint32_t leaves = 5000;
};
struct TreeParts {
  Mesh wood, leaf;
  std::vector<Imath::M44d> leaves;  // for row vectors
};
[[nodiscard]] TreeParts make_tree(const Tree& tree);

struct NoiseSphere {
  std::uint64_t seed = 0;
  double radius = 1;
  double amplitude = 0.25;        // of the noise, beside the radius
  Imath::V3d frequency{2, 2, 2};  // of its largest folds, along each axis
  std::uint32_t octaves = 6;      // each twice as fine as the one before, and half as high
  std::uint32_t segments = 64;    // of the edges of the cube that it is made of
};
// 12 segments^2 triangles. It is smooth, and uv is [0, 1]^2 on each of the cube's faces.
[[nodiscard]] Mesh make_noise_sphere(const NoiseSphere& sphere);

struct Tuft {
  std::uint64_t seed = 0;
  double height = 0.4;
  double spread = 0.1;   // radius of the disk that the blades grow from
  double width = 0.015;  // of a blade at its root
  double bend = 0.5;     // how far a blade leans out at its tip, beside its length
  std::uint32_t blades = 40;
};
[[nodiscard]] Mesh make_tuft(const Tuft& tuft);

// Places of `count` copies on a rectangle about the origin, evenly at random (the R2 sequence of M.
// Roberts 2018), each turned about y and scaled by a number in [least, most].
struct Scatter {
  std::uint64_t seed = 0;
  std::uint32_t count = 1;
  double width = 1, depth = 1;  // along x and z
  double least = 1, most = 1;
};
[[nodiscard]] std::vector<Imath::M44d> scatter(const Scatter& how);

}  // namespace psf::render
