// [fireflies]: whom each firefly gives what it does not keep.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/problem.h"

namespace psf::filter {

// What is bright, in a compact order.
struct Bright {
  std::span<const std::uint32_t> records;  // record numbers
  std::span<const float> luminance;        // of each
};

// By place in Bright.
struct Receivers {
  // Record numbers of those that get a share, the firefly among them; empty where the bright are even
  // around it, so that it is none.
  std::vector<std::vector<std::uint32_t>> of;
  std::vector<float> reach;    // R_j; 0 where there are no receivers
  std::vector<double> shares;  // 1 / N_j; so too
};

// Throws Error{interrupted} on ^C.
[[nodiscard]] Receivers find_receivers(const Problem& problem, EngineKind engine,
                                       const Bright& bright);

}  // namespace psf::filter
