// Queries without a source in their ball: where their average comes from instead.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/problem.h"
#include "search/search.h"

namespace psf::filter {

// An orphan averages at most this many sources.
inline constexpr std::size_t kOrphanSources = 4;

// What an orphan averages: the kOrphanSources nearest of the sources that pass the weights, ties by
// the lower record. Where none passes: the nearest of all, and not `matched`.
struct Adopted {
  std::vector<std::uint32_t> sources;  // record numbers, nearest first
  bool matched = true;
};

// `search` holds the positions of the problem's sources.
[[nodiscard]] Adopted adopt(const search::Search& search, const Problem& problem, std::uint32_t i);

// Their mean, without areas: an orphan is no density. Adds to the counts of orphans.
[[nodiscard]] Rgb average_of(const Adopted& adopted, std::span<const Rgb> values,
                             Statistics& statistics);

}  // namespace psf::filter
