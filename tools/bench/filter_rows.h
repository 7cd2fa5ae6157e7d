// The filter's rows: the fast engine over plain FLANN, threads over one, twice the passes over
// once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/filter_run.h"

namespace psf::bench {

// Whether the two engines found the same; adds up over runs.
struct Agreement {
  std::uint64_t differing = 0;  // records with another number of neighbours, or another role
  double c_bar = 0;             // largest relative difference of a component

  void add(const filter::Average& a, const filter::Average& b);
};
[[nodiscard]] std::vector<Row> agreement_rows(const Agreement& agreement);

// Time of plain / time of flann, one thread, in turn. The target is that of `wanted` neighbours, if
// there is one. Adds a point for each.
[[nodiscard]] Row speed_row(const Sample& sample, const Reach& reach, std::size_t wanted,
                            std::size_t repeat, Agreement& agreement, std::vector<Point>& points);

// Time of one thread / time of `threads`, in turn.
[[nodiscard]] Row threads_row(const Sample& sample, const Reach& reach, std::size_t threads,
                              std::size_t repeat);

// One thread, a pass a block: time of an even number of passes / time of the first half of them.
// The sample has at least two.
[[nodiscard]] Row passes_row(const Sample& sample, const Reach& reach, std::size_t repeat);

}  // namespace psf::bench
