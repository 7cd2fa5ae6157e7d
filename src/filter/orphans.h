// Orphans, the queries without a source in their ball that passes the weights, and the sources that
// they average instead.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/problem.h"
#include "search/search.h"

namespace psf::filter {

// An orphan averages at most this many sources.
inline constexpr std::size_t kOrphanSources = 4;

// The sources that an orphan averages: the kOrphanSources nearest that pass the weights; the lower
// record wins ties. Where none passes, it is the nearest source, and `matched` is false.
struct Adopted {
  std::vector<std::uint32_t> sources;  // record numbers, nearest first
  bool matched = true;
};

// Finds the sources for the orphan i. `search` holds the positions of the problem's sources.
[[nodiscard]] Adopted adopt(const search::Search& search, const Problem& problem, std::uint32_t i);

// The mean of `values` over the adopted sources, without the areas of [disk].
[[nodiscard]] Rgb mean_of(const Adopted& adopted, std::span<const Rgb> values);
// Writes the means for the orphan i of everything that is averaged, and counts the orphan.
void average_adopted(const Adopted& adopted, std::uint32_t i, std::span<const Averaged> all,
                     Statistics& statistics);

}  // namespace psf::filter
