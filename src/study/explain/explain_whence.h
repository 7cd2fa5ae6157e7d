// Whence a pixel's light came: who raised or lowered it against what its own paths say, what tells
// those apart, and what would have refused them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec.h"
#include "study/explain/explain.h"

namespace psf::study {

using Colour = Imath::V3d;  // linear, Rec. 709 primaries
[[nodiscard]] double luminance(const Colour& colour);

// Of the N paths that are part of the pixel.
struct PixelSums {
  std::uint64_t paths = 0;      // N
  Colour filtered{0, 0, 0};     // [pixel]
  std::uint64_t own_paths = 0;  // of them, those with a radiance of their own
  std::optional<Colour> own;    // their mean, unfiltered
  double own_error = 0;         // standard error of the part of its luminance that is averaged,
                                // alpha_i c_i; 0 for a single path
  std::size_t brightest = 0;    // the path with most luminance of its own, place in ::paths
  double brightest_share = 0;   // of `own`
  Colour baseline{0, 0, 0};     // o = sum alpha_i c_i / sum alpha_i over its own sources
  Colour difference{0, 0, 0};   // sum alpha_i (c_bar_i - o) / N: filtered - own where no path
                                // lacks a contribution
};

// A source j over all paths that average it.
struct SourceShare {
  std::uint32_t vertex = 0, paths = 0;
  std::size_t pair = 0;    // that with most excess
  Colour share{0, 0, 0};   // what it adds to the pixel: sum alpha_i c_j / (count_i N)
  Colour excess{0, 0, 0};  // beyond what o in its place would add; they sum to the difference
};

// The sources of one pixel; means over pairs.
struct PixelShare {
  std::uint16_t camera = 0;
  std::uint32_t pixel = 0;  // y * width + x
  std::uint64_t sources = 0, pairs = 0, leaking = 0;
  Colour share{0, 0, 0}, excess{0, 0, 0};
  double angle = 0;                 // between the normals, degrees
  double reflectance = 0;           // difference
  double lights = 0, material = 0;  // share of pairs that differ
  double plane = 0;                 // signed distance off the tangent plane of x_i, in radii
};

// Averaged pairs, the path's own left out, by the set of terms that would tell them apart at these
// thresholds: those of the run, or the filter's defaults, kPlaneApart for `plane`.
inline constexpr float kPlaneApart = 0.25f;
struct KindShare {
  std::uint32_t terms = 0;  // bit k: term k of filter::kTermNames; never hit-distance, direction
  std::uint64_t pairs = 0, leaking = 0;
  Colour excess{0, 0, 0};
};

// The radii stay as they are, also where `adaptive` would choose others.

// A term that is on: of the pairs in the balls, those it refuses at all, and those that no other
// refuses; and the pixel without it.
struct TermRefusals {
  std::size_t term = 0;
  std::uint64_t refused = 0, alone = 0;
  Colour without{0, 0, 0};
};

// A term at a threshold that it does not have: the best one of a ladder for telling the sources
// that leak from the others. `visibility` and `material` have none.
struct Remedy {
  std::size_t term = 0;
  std::optional<float> threshold;
  std::uint64_t leaking = 0, others = 0;  // averaged pairs that it would also refuse
  Colour pixel{0, 0, 0};                  // what it would be
  [[nodiscard]] double gain(std::uint64_t all_leaking, std::uint64_t all_others) const;
};

struct Whence {
  PixelSums pixel;
  std::uint64_t candidates = 0;  // pairs in the balls
  std::vector<TermRefusals> refusals;
  // Averaged sources, those that push the pixel the way it went first.
  std::vector<SourceShare> sources;
  // The fewest of them, from the first on, whose excesses make up the difference; and the averaged
  // pairs they and the others are in, without the paths' own.
  std::size_t leak = 0;
  std::uint64_t leak_pairs = 0, other_pairs = 0;
  std::vector<PixelShare> pixels;  // in the same order
  std::vector<KindShare> kinds;    // in the same order
  std::vector<Remedy> remedies;    // best first; without those that refuse nothing
};

[[nodiscard]] Whence whence(const Explanation& explanation);

// What a pair adds to the pixel of N paths.
[[nodiscard]] Colour share_of(const Explanation& explanation, const ExplainedPair& pair,
                              std::uint64_t paths);

// What tells a source from the vertex it is averaged into; not set where the file has no such
// channel.
struct PairFeatures {
  std::optional<double> angle;          // between the normals, degrees
  std::optional<double> reflectance;    // norm of the difference
  std::optional<std::uint32_t> lights;  // visibility bits that differ
  std::optional<double> hit_distance;   // relative difference; infinity: one is a miss
  std::optional<double> plane;          // signed, in radii; > 0 on the normal's side
  std::optional<double> direction;      // angle between, degrees
  std::optional<bool> material;         // differs
};
[[nodiscard]] PairFeatures features_of(const Explanation& explanation, const ExplainedPair& pair);

}  // namespace psf::study
