// Queries without a source in their ball: where their average comes from instead.
#pragma once

#include <cstdint>
#include <vector>

#include "filter/roles.h"
#include "filter/weights.h"
#include "search/search.h"

namespace psf::filter {

// An orphan averages at most this many sources.
inline constexpr std::size_t kOrphanSources = 4;

// The kOrphanSources nearest of the sources that pass the weights among the k nearest of all, ties
// by the lower record; k is the first of 16, 64, 256, 1024 and all of them that holds one which
// passes. Where no source of the block passes: the nearest, and false. `search` holds the positions
// of `sources`, at least one.
[[nodiscard]] bool adopt(const search::Search& search, const Records& records,
                         const std::vector<std::uint32_t>& sources, const Weights& weights,
                         std::uint32_t i, float r_i, std::vector<search::Neighbor>& scratch,
                         std::vector<std::uint32_t>& out);

}  // namespace psf::filter
