// The plain engine: one neighbour search a query, one loop over what it found.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/roles.h"
#include "filter/weights.h"
#include "search/search.h"

namespace psf::filter {

// What is to be averaged; all spans by record number.
struct Problem {
  const Records& records;
  const Roles& roles;
  std::span<const float> radius;         // r_i
  std::span<const std::uint32_t> order;  // the queries, in the order to work on them
  const search::Search& search;          // over the positions of roles.sources, in their order
  const Weights& weights;
  std::span<const float> area;  // A_j of [disk]; empty: [average]
  bool count_refusals = false;
};

// One application of [average] or [disk]: out[i] for every query from `values` of the sources, and
// neighbors[i], how many of them it was; 0 for an orphan. Adds to `statistics` what it counts. Same
// result for any number of threads. Throws Error{interrupted} on ^C.
void plain_average(const Problem& problem, std::span<const Rgb> values, std::span<Rgb> out,
                   std::span<std::uint32_t> neighbors, Statistics& statistics);

}  // namespace psf::filter
