// The error of filtered pictures without a reference, from independent parts of a dump.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filter/parameters.h"
#include "study/dump.h"
#include "study/noise_share.h"
#include "study/passes.h"

namespace psf::study {

// Estimates of relMSE and its parts, of the picture that all passes give; squares are divided by
// g^2 + epsilon, where g stands for the reference: median_around() of the picture without filter,
// which is the same for all sets and which none can raise. With a filtered picture as g what a set
// smears would make its own relative error seem small.
struct TuneRow {
  filter::Parameters parameters;
  double error = 0;           // bias_sq + variance + u_variance + u_covariance - constant
  double standard_error = 0;  // of bias_sq + variance
  // Means over pairs of parts: of (F_A - A) (F_B - B), whose expected value is bias^2 because parts
  // are independent; of (f_A - f_B)^2 / (1 / a + 1 / b), a and b the parts' shares of the paths.
  // f is F without u, whose noise no set changes.
  double bias_sq = 0, variance = 0;
  // How many standard errors of the difference this row's error lies above the least one.
  double distance = 0;
  // Whether its error may be less than that of the choice over 1 + kTolerance.
  bool may_be_better = false;
  double neighbors = 0;
};

struct Tuning {
  std::vector<TuneRow> rows;  // in the order of the sets
  std::size_t best = 0;       // the choice: the row of the least error
  std::size_t parts = 0;      // that were compared
  double unfiltered = 0;      // relMSE of the unfiltered picture
  // What u adds to every error: its variance, and twice its covariance with f, which is below 0
  // where they make up for each other. The covariance is that of the choice: it comes from alpha,
  // which no set changes, so it is nearly the same for all sets. So neither ranks them.
  double u_variance = 0, u_covariance = 0;
  // Of the unfiltered picture, of the paths that the first set's `sources` chooses; a path is left
  // out where u, alpha, x or c is not finite, whatever else the sets would leave out.
  NoiseShare noise;
  // The least bias_sq where it is below 0, else 0: parts of one low-discrepancy sequence make up
  // for each other, so that their noise correlates and every bias_sq is off by this much.
  double constant = 0;
  // Correlation of the noise of two parts at a pixel: 0 where they are independent.
  double correlation = 0;
  // Whether the dump's sampler draws every path for itself.
  bool has_independent_paths = false;
};

struct Tune {
  std::span<const filter::Parameters> sets;
  PassSelection passes;
  std::size_t camera = 0;
  double epsilon = 1e-2;
  std::optional<std::uint64_t> max_memory;  // bytes; the noise, read last, takes less than the rest
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths, read again
};

// Blocks go to four parts in turn, or to two where a set has fewer than four, filtered as the whole
// run filters them: F, and A of the same paths without filter. Throws what filter_many() throws;
// Error{usage} where a set has one block alone.
[[nodiscard]] Tuning tune(const Dump& dump, const Tune& tune);

// A choice is good where no set's error is less than its own over 1 + kTolerance, and known to be
// good where that holds by kSure standard errors for every set.
inline constexpr double kTolerance = 0.15, kSure = 2;

}  // namespace psf::study
