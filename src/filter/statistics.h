// Counts and times of a filter run; those of blocks are added up.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "filter/weights.h"

namespace psf::filter {

// Channels whose non-finite values take a record out of the averages.
inline constexpr std::size_t kCheckedChannels = 10;
inline constexpr std::array<const char*, kCheckedChannels> kCheckedNames = {
    "unfiltered", "throughput",  "position",     "distance",  "contribution",
    "normal",     "reflectance", "hit_distance", "direction", "roughness"};

struct Statistics {
  std::uint64_t records = 0;
  std::uint64_t without_vertex = 0;    // contribute u_i alone
  std::uint64_t queries = 0;           // records with a vertex, in use
  std::uint64_t sources = 0;           // queries that are sources
  std::uint64_t photons = 0;           // of [density], of every block anew
  std::uint64_t photons_left_out = 0;  // not finite, and not among them

  std::uint64_t left_out = 0;  // records left out of averages and pictures
  // Records left out, by channel of kCheckedNames; a record counts for each channel that is not
  // finite.
  std::array<std::uint64_t, kCheckedChannels> non_finite{};
  std::uint64_t without_source = 0;  // queries in blocks without any source; also left out

  // The number of pairs (i, j) with chi = 1, the pair (i, i) included, and of those that each term
  // of kTermNames alone refuses; counted only with Parameters::count_refusals.
  std::uint64_t candidates = 0;
  std::array<std::uint64_t, kTermCount> refused{};
  std::uint64_t accepted = 0;  // pairs with chi w_ij = 1
  std::uint64_t min_neighbors = std::numeric_limits<std::uint64_t>::max();  // sources of a query
  std::uint64_t max_neighbors = 0;
  std::uint64_t orphans = 0;            // queries without a source in their ball that passes
  std::uint64_t orphans_unmatched = 0;  // orphans for which no source passes the weights

  // Of the fireflies of the rules spread and clamp, and the sums of luminance of all sources and of
  // what was spread or dimmed.
  std::uint64_t fireflies = 0;
  double light = 0, light_apart = 0;

  double seconds_index = 0;   // roles, order, building the index
  double seconds_filter = 0;  // search, weights and sums

  Statistics& operator+=(const Statistics& other);
  // Counts a query that averages over `neighbors` sources.
  void add_query(std::uint64_t neighbors) {
    accepted += neighbors;
    min_neighbors = std::min(min_neighbors, neighbors);
    max_neighbors = std::max(max_neighbors, neighbors);
  }
  // Counts an orphan; `matched`: some source passes its weights.
  void add_orphan(bool matched) {
    ++orphans;
    orphans_unmatched += matched ? 0 : 1;
  }
  [[nodiscard]] double mean_neighbors() const {
    return queries == 0 ? 0 : static_cast<double>(accepted) / static_cast<double>(queries);
  }
};

}  // namespace psf::filter
