// Every parameter of the filter, with its default. The equations are in README.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "filter/parameters/estimators.h"
#include "filter/parameters/terms.h"

namespace psf::filter {

// f_i of [radius].
enum class RadiusBasis : std::uint8_t {
  distance,   // d_i: r0 is a fraction of it
  footprint,  // d_i times the camera's angle per pixel: r0 is in pixels
  world       // 1: r0 is in world units
};

// n of [radius].
enum class RadiusCount : std::uint8_t {
  samples,  // samples per pixel accumulated up to the end of the block
  blocks    // blocks up to and with this one
};

struct Radius {
  // >= 0; 0 filters nothing. Pixels are the default because a fraction of the distance means
  // another number of neighbours for every field of view and resolution; measured in README.md.
  double r0 = 8;
  RadiusBasis basis = RadiusBasis::footprint;
  // 0 <= delta < 1. 0 keeps the radius fixed: no longer consistent, but useful to look at one
  // radius.
  double delta = 1.0 / 3;
  RadiusCount count = RadiusCount::samples;
};

// Which paths are averaged with each other.
struct BlockSize {
  enum class Kind : std::uint8_t { power, passes, all };
  Kind kind = Kind::passes;
  std::uint32_t base = 2, exponent = 16;  // power: base^exponent contiguous paths, base >= 2
  std::uint64_t passes = 4;               // passes: this many, >= 1; measured in README.md
};

// What of the contributions in a ball is c_bar_i.
enum class BallFit : std::uint8_t {
  mean,   // [average]
  linear  // [fit]
};

// What becomes of contributions far brighter than those around them.
struct FireflyRule {
  enum class Kind : std::uint8_t {
    keep,    // averaged like any other
    spread,  // [fireflies]: given out over a distance of their own
    clamp    // dimmed to `limit` times sqrt(n) times the ordinary brightness of their ball
  };
  Kind kind = Kind::keep;
  double limit = 1;  // of clamp; at least 1, finite

  [[nodiscard]] bool keeps() const { return kind == Kind::keep; }
  [[nodiscard]] bool spreads() const { return kind == Kind::spread; }
};

// What becomes of a pixel's mean over its filtered paths.
enum class PixelRule : std::uint8_t {
  keep,    // it is the picture
  regress  // [second]: it gives way to a fit over the pixels around
};

// What finds the neighbours; the result is the same.
enum class EngineKind : std::uint8_t {
  flann,  // engine/: FLANN over groups of records
  plain,  // FLANN, one search a record
  brute   // tests every pair: the oracle
};

struct Parameters {
  Radius radius;
  BlockSize block;
  WeightTerms weights;
  bool demodulate = false;       // average c_j / rho_j, multiply by rho_i
  std::uint32_t iterations = 1;  // >= 1
  std::uint32_t sources = 1;  // K >= 1: one record in K is a source, the others are queries alone
  Estimator estimator = Estimator::average;
  // For [adaptive], > 0: a ball grows until the mean of the ring around it differs from its own by
  // more than this many standard errors; measured in README.md.
  double agree = 1.5;
  BallFit fit = BallFit::mean;
  FireflyRule fireflies;
  PixelRule pixels = PixelRule::keep;  // of pictures; estimates of records do not know it
  EngineKind engine = EngineKind::flann;
  bool count_refusals = false;  // pairs in the balls and refusals by term; about doubles the time

  // Throws Error{usage} naming the parameter and what it may be.
  void validate() const;
};

// A channel that parameters need, the parameter that needs it, and how to do without the channel:
// {"normal", "`normal`", "give `normal off`", Term::normal}.
struct ChannelNeed {
  std::string_view channel;
  std::string wanted_by, instead;
  std::optional<Term> term = {};
};
// The channels that `parameters` need in addition to `position`, `throughput`, `contribution`,
// `distance` and `pixel`, which every dump has.
[[nodiscard]] std::vector<ChannelNeed> optional_channels(const Parameters& parameters);
// Whether d_i, and whether the cameras' angle per pixel, is used: by the radius or by the
// estimator.
[[nodiscard]] bool needs_distance(const Parameters& parameters);
[[nodiscard]] bool needs_angle(const Parameters& parameters);

}  // namespace psf::filter
