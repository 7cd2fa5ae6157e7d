// Where a pixel's light came from: the sources that raised or lowered it against its own paths, the
// features in which these sources differ, and the terms that would have refused them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec.h"
#include "explain/pairs.h"

namespace psf::explain {

[[nodiscard]] double luminance(const Colour& colour);

// Sums over the N paths that are part of the pixel.
struct PixelSums {
  std::uint64_t paths = 0;      // N
  Colour filtered{0, 0, 0};     // [pixel]
  std::uint64_t own_paths = 0;  // number of paths that have an unfiltered radiance
  std::optional<Colour> own;    // mean of these paths' unfiltered radiance
  double own_error = 0;        // standard error of the mean luminance of alpha_i c_i; 0 of one path
  std::size_t brightest = 0;   // place in ::paths of the path with most unfiltered luminance
  double brightest_share = 0;  // share of that path in `own`
  Colour baseline{0, 0, 0};    // o = sum alpha_i c_i / sum alpha_i over its own sources
  // sum alpha_i (c_bar_i - o) / N; it is filtered - own where every path has a contribution.
  Colour difference{0, 0, 0};
  Colour of_means{0, 0, 0};  // the pixel with means in place of [fit]
  Colour given{0, 0, 0};     // the part of `filtered` that fireflies have given
};

// A source j, summed over all paths that it brings light to.
struct SourceShare {
  std::uint32_t vertex = 0, paths = 0;
  std::size_t pair = 0;    // the pair with most excess
  Colour share{0, 0, 0};   // what it adds to the pixel: sum alpha_i c_j / (count_i N), of a mean
  Colour given{0, 0, 0};   // the part of this that it gives as a firefly
  Colour excess{0, 0, 0};  // what it adds beyond o in its place; the excesses sum to the difference
};

// The sources that lie in one pixel; angle to plane are means over pairs.
struct PixelShare {
  std::uint16_t camera = 0;
  std::uint32_t pixel = 0;  // y * width + x
  std::uint64_t sources = 0, pairs = 0, leaking = 0;
  Colour share{0, 0, 0}, excess{0, 0, 0};
  double angle = 0;                 // between the normals, degrees
  double reflectance = 0;           // norm of the difference
  double lights = 0, material = 0;  // share of pairs that differ
  double plane = 0;                 // signed distance off the tangent plane of x_i, in radii
};

// The pairs that bring light, without those of a path with itself, by the set of terms that would
// tell the two records apart. The thresholds are those of the run, or the filter's defaults, or
// kApart where it has none (`plane`).
inline constexpr float kApart = 0.25f;
struct KindShare {
  std::uint32_t terms = 0;  // bit k: term k, of those with TermInfo::apart
  std::uint64_t pairs = 0, leaking = 0;
  Colour excess{0, 0, 0};
};

// TermRefusals and Remedy leave the radii as they are, also where `adaptive` would choose others; and
// who is a firefly, what it keeps, and what it gives to those to whom it still gives.

// For a term that is on: the number of pairs in the balls that it refuses, the number that it alone
// refuses, and the pixel without the term.
struct TermRefusals {
  std::size_t term = 0;  // kTermCount: what keeps volumes and surfaces apart
  std::uint64_t refused = 0, alone = 0;
  Colour without{0, 0, 0};
};

// A term with another threshold than in the run: of a list of thresholds, the one that best tells
// the sources that leak from the others. `visibility` and `material` have no threshold.
struct Remedy {
  std::size_t term = 0;
  std::optional<float> threshold;
  std::uint64_t leaking = 0, others = 0;  // pairs that bring light that it would refuse
  Colour pixel{0, 0, 0};                  // value of the pixel with this term
  [[nodiscard]] double gain(std::uint64_t all_leaking, std::uint64_t all_others) const;
};

struct Attribution {
  PixelSums pixel;
  std::uint64_t candidates = 0;  // pairs in the balls
  std::vector<TermRefusals> refusals;
  // The sources that bring light. Those that push the pixel in the direction of the difference come
  // first.
  std::vector<SourceShare> sources;
  // `leak` is the least number of sources, from the first on, whose excesses make up the
  // difference. The others are the numbers of pairs that bring light, with these sources and with
  // all others, without the pairs of paths with themselves.
  std::size_t leak = 0;
  std::uint64_t leak_pairs = 0, other_pairs = 0;
  std::vector<PixelShare> pixels;  // in the same order as `sources`
  std::vector<KindShare> kinds;    // in the same order as `sources`
  std::vector<Remedy> remedies;    // best first; without those that refuse nothing
};

[[nodiscard]] Attribution attribute(const ExplainResult& explanation);

}  // namespace psf::explain
