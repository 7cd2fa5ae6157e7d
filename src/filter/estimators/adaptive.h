// [adaptive]: for every query the largest radius up to which contributions agree.
#pragma once

#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/problem.h"

namespace psf::filter {

// The number of radii: r_i 2^(-k/2) for k = 0 ... kAdaptiveRadii - 1; the least is below r_i / 10.
inline constexpr std::size_t kAdaptiveRadii = 8;
inline constexpr double kAdaptiveLeastShare = 1.0 / 16;  // no radius is below this share of r_i

// Chooses a radius for every query; returns them by record number, 0 for other records.
// problem.radius holds the largest radius of each query, `values` the sources' values that are
// averaged, by record number. The result is the same for any number of threads and any `kind`.
// Throws Error{interrupted} on ^C.
[[nodiscard]] std::vector<float> adaptive_radii(EngineKind kind, const Problem& problem,
                                                std::span<const Rgb> values, double agree);

}  // namespace psf::filter
