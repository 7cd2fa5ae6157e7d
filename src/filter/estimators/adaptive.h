// [adaptive]: a radius for every query, the largest up to which contributions agree.
#pragma once

#include <span>
#include <vector>

#include "filter/parameters.h"
#include "filter/problem.h"

namespace psf::filter {

// Radii r_i 2^(-k/2), k below this: from r_i down to less than a tenth of it.
inline constexpr std::size_t kAdaptiveRadii = 8;
inline constexpr double kAdaptiveLeastShare = 1.0 / 16;  // of r_i: none of them is less

// Of every query, one of its radii, where problem.radius has the largest; 0 elsewhere. `values` of
// the sources, by record number, are what is averaged. Same result for any number of threads and
// any `kind`. Throws Error{interrupted} on ^C.
[[nodiscard]] std::vector<float> adaptive_radii(search::Kind kind, const Problem& problem,
                                                std::span<const Rgb> values, double agree);

}  // namespace psf::filter
