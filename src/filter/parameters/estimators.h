// The estimators of c_bar: which there are, what each needs, takes and refuses, in one table. How
// an estimator computes is in estimators/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "filter/parameters/terms.h"

namespace psf::filter {

enum class Estimator : std::uint8_t {
  average,   // [average]
  disk,      // [disk], as in photon mapping: the sum over the area of the ball's disk
  hash,      // [hash]: averages over the cells of a jittered grid, without search
  control,   // [control]: each half of the sources as control variate of the other; unbiased
  adaptive,  // [adaptive]: [average] in the largest ball whose contributions agree
  density    // [density]: photons in the ball over the area of its disk
};

inline constexpr std::size_t kEstimatorCount = 6;

struct Parameters;

// What does not go with an estimator.
struct Refusal {
  bool (*applies)(const Parameters&);
  std::string_view message;  // "`plane`: why not; what to give instead"
};

struct EstimatorInfo {
  std::string_view name;
  std::string_view meaning;  // in a few words, for a help; "" where the name says it
  // The channels it needs beside those that every dump has and those of the weights; "": none.
  std::array<std::string_view, 2> channels = {};
  std::span<const Refusal> refusals = {};
  // The terms of w_ij that it can apply; the others are not asked.
  TermSet terms = (TermSet{1} << kTermCount) - 1;
  // Its sources are Records::photons, which have no part in c_i, and not the records.
  bool is_of_photons = false;
  // c_bar_i is made of the sources in the ball of i, so that pairs can be counted and explained.
  bool is_of_ball = true;
  // Its sums are over the area of the ball's disk, not over their number: it needs the distance and
  // the camera's angle per pixel.
  bool is_over_area = false;
  // It is a mean over a ball: [fit] can take its place, and [fireflies] be told by it.
  bool fits = false;
  // estimate_many() finds what it gives for many radii in one traversal.
  bool shares_traversal = false;
  // The least share of r_i that it uses as a radius. Below 1: it chooses radii of its own, as the
  // parameter `agree` says.
  double least_share = 1;
  // What it finds from the whole light and applies to every layer of it; "": nothing.
  std::string_view of_the_whole = "";
  // Memory in bytes per record beside the tree over the sources, where it has one.
  std::uint64_t bytes = 0;
  bool has_tree = true;
};

// By the value of Estimator.
[[nodiscard]] std::span<const EstimatorInfo> estimators();
[[nodiscard]] inline const EstimatorInfo& info(Estimator estimator) {
  return estimators()[static_cast<std::size_t>(estimator)];
}

}  // namespace psf::filter
