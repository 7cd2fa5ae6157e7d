// The rows about the filter: speed of the fast engine against plain FLANN, of several threads
// against one, and of all passes against half of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/filter_run.h"

namespace psf::bench {

// The differences between the results of two engines, over all runs.
struct Agreement {
  std::uint64_t differing = 0;  // records whose number of neighbours or role differs
  double c_bar = 0;             // largest relative difference of a component

  void add(const filter::Estimates& a, const filter::Estimates& b);
};
[[nodiscard]] std::vector<Row> agreement_rows(const Agreement& agreement);

// Time of the plain engine / time of the fast one, on one thread, run in turn. The target is that
// for `wanted` neighbours, if there is one. Adds a point for each engine.
[[nodiscard]] Row speed_row(const Sample& sample, const Reach& reach, std::size_t wanted,
                            std::size_t repeat, Agreement& agreement, std::vector<Point>& points);

// Time of one thread / time of `threads` threads, run in turn.
[[nodiscard]] Row threads_row(const Sample& sample, const Reach& reach, std::size_t threads,
                              std::size_t repeat);

// Time of an even number of passes / time of the first half of them, on one thread, with one pass
// per block. The sample must have at least two passes.
[[nodiscard]] Row passes_row(const Sample& sample, const Reach& reach, std::size_t repeat);

}  // namespace psf::bench
