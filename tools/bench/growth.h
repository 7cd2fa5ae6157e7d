// How the filter's cost grows with the neighbours of a record and with the records of a block.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "bench/filter_run.h"

namespace psf::bench {

inline constexpr std::size_t kGrowthNeighbors[] = {10, 35, 100, 400, 1000, 3000, 10000};
// At so many neighbours the records grow, from 2^14 in steps of 4 times.
inline constexpr std::size_t kFixedNeighbors = 60, kFirstRecords = std::size_t{1} << 14;

// The fast engine on one thread. Nothing where no radius gives so many neighbours; `reach` of the
// point has the one that does.
[[nodiscard]] std::optional<Point> growth_point(const Sample& sample, const char* series,
                                                std::size_t neighbors, double start,
                                                std::size_t repeat);

// The points of a series in order, each with the exponent of the growth from the one before: of
// the time of a record over neighbours, of the whole time over records.
void print_growth(const std::vector<Point>& points);

}  // namespace psf::bench
