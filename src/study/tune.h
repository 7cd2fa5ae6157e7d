// The error of filtered pictures without a reference, from independent parts of a dump.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "run/dump.h"
#include "run/noise_share.h"
#include "run/passes.h"

namespace psf::study {

// Estimates of relMSE and its parts for the picture that all passes give. Squares are divided by
// g^2 + epsilon, where g replaces the reference: the median_around() of the picture without filter.
// This is the same for all sets, and no set can raise it. With a filtered picture as g, a set that
// blurs bright light into dark places would make its own relative error seem small.
struct TuneRow {
  filter::Parameters parameters;
  double error = 0;           // bias_sq + variance + u_variance + u_covariance - constant
  double standard_error = 0;  // standard error of bias_sq + variance
  // Means over pairs of parts. bias_sq is the mean of (F_A - A) (F_B - B), whose expected value is
  // bias^2 because parts are independent. variance is the mean of (f_A - f_B)^2 / (1 / a + 1 / b),
  // where a and b are the parts' shares of the paths, and f is F without u, whose noise no set
  // changes.
  double bias_sq = 0, variance = 0;
  // The difference of this row's error and the least error, in standard errors of the difference.
  double sigmas_above_least = 0;
  // Whether this row's error may be less than the error of the choice over 1 + kTolerance.
  bool may_be_better = false;
  double neighbors = 0;
};

struct TuneResult {
  std::vector<TuneRow> rows;  // in the order of the sets
  std::size_t best = 0;       // the choice: number of the row with the least error
  std::size_t parts = 0;      // number of parts that were compared
  double unfiltered = 0;      // relMSE of the unfiltered picture
  // What u adds to every error: its variance, and twice its covariance with f, which is below 0
  // where u and f compensate each other. The covariance is that of the choice; it comes from alpha,
  // which no set changes, so it is nearly the same for all sets. Neither changes the order of the
  // sets.
  double u_variance = 0, u_covariance = 0;
  // The noise of the unfiltered picture, for the paths that the first set's `sources` chooses.
  // Paths where u, alpha, x or c is not finite are left out, whatever else the sets would leave
  // out.
  run::NoiseShare noise;
  // The least bias_sq where it is below 0, else 0. Parts of one low-discrepancy sequence compensate
  // each other, so that their noise correlates and every bias_sq is off by this much.
  double constant = 0;
  // Correlation of the noise of two parts at a pixel: 0 where they are independent.
  double correlation = 0;
  // Whether the dump's sampler draws every path for itself.
  bool has_independent_paths = false;
};

struct TuneRequest {
  std::span<const filter::Parameters> sets;
  run::PassSelection passes;
  std::size_t camera = 0;
  double epsilon = 1e-2;
  std::optional<std::uint64_t> max_memory;                                   // limit in bytes
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // in paths read
};

// Estimates the error of each set. The blocks, filtered as in the whole run, go to four parts in
// turn, or to two parts where a set has fewer than four blocks. Each part gives a filtered picture
// F, and the picture A of the same paths without filter; without second pass. Throws Error{usage} where a set has only
// one block, and what filter_many() throws.
[[nodiscard]] TuneResult tune(const run::Dump& dump, const TuneRequest& tune);

// A choice is good where no set's error is below the choice's error over 1 + kTolerance. It is
// known to be good where this holds by kSure standard errors for every set.
inline constexpr double kTolerance = 0.15, kSure = 2;

// The radii that are tried unless others are asked for, as a list of texts.
inline constexpr const char* kTuneRadii = "2px,2.8px,4px,5.7px,8px,11.3px,16px,22.6px,32px";

}  // namespace psf::study
