// How the filter's cost grows with the neighbours of a record and with the records of a block.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "bench/filter_run.h"

namespace psf::bench {

inline constexpr std::size_t kGrowthNeighbors[] = {10, 35, 100, 400, 1000, 3000, 10000};
// The series of records has kFixedNeighbors neighbours, and begins with 2^14 records; each step has
// four times as many.
inline constexpr std::size_t kFixedNeighbors = 60, kFirstRecords = std::size_t{1} << 14;

// Measures the fast engine on one thread. Not set where no radius gives so many neighbours.
// `start`: r0 to try first, 0 where none is known; the point's `reach` has the radius that was
// found.
[[nodiscard]] std::optional<Point> growth_point(const Sample& sample, const char* series,
                                                std::size_t neighbors, double start,
                                                std::size_t repeat);

// Prints the points of a series in order, each with the exponent of the growth since the point
// before: of the time per record over neighbours, or of the whole time over records.
void print_growth(const std::vector<Point>& points);

}  // namespace psf::bench
