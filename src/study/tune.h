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
#include "study/passes.h"

namespace psf::study {

// Estimates of relMSE and its parts; squares are divided by g^2 + epsilon, where g stands for the
// reference: the filtered picture of the best set of the first traversal, of other parts than those
// whose error it weights, so that a bright spot that a rare path leaves does not make the relative
// error of the spot itself seem small.
struct TuneRow {
  filter::Parameters parameters;
  double error = 0;           // bias_sq + variance - constant, of the run over all passes
  double standard_error = 0;  // of `error`
  // Means over pairs of parts: of (F_A - A) (F_B - B), whose expected value is bias^2 because parts
  // are independent; of (F_A - F_B)^2 / (1 / a + 1 / b), a and b the parts' shares of the paths.
  double bias_sq = 0, variance = 0;
  // How many standard errors of the difference this row's error lies above the least one.
  double distance = 0;
  double neighbors = 0;
};

struct Tuning {
  std::vector<TuneRow> rows;  // in the order of the sets
  std::size_t least = 0;      // the row of the least error
  // The choice: of all rows within kAlike standard errors of the least, the one that averages over
  // the fewest neighbours, because rare bright paths, whose spread is what large radii do wrong,
  // are what an estimate from few passes knows least of.
  std::size_t best = 0;
  std::size_t parts = 0;  // that were compared
  double unfiltered = 0;  // relMSE of the unfiltered picture
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
  std::optional<std::uint64_t> max_memory;                                   // bytes
  std::function<void(std::uint64_t done, std::uint64_t total)> on_progress;  // paths
};

// Blocks go to four parts in turn, or to two where a set has fewer than four (then g is the darker
// of both, which is less sure), filtered as the whole run filters them: F, and A of the same paths
// without filter. Throws what filter_many() throws; Error{usage} where a set has one block alone.
[[nodiscard]] Tuning tune(const Dump& dump, const Tune& tune);

// Rows this close to the least error may as well have it.
inline constexpr double kAlike = 2;  // standard errors

}  // namespace psf::study
