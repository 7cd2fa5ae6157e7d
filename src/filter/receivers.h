// [fireflies]: whom each firefly gives what it does not keep.
#pragma once

#include <cstdint>
#include <vector>

#include "filter/problem.h"

namespace psf::filter {

// A firefly j.
struct Firefly {
  std::uint32_t record = 0;
  float luminance = 0;    // Y_j
  double ordinary = 0;    // m_j
  float kept = 1;         // p_j, in [0, 1)
  float reach = 0;        // R_j; 0 where nothing is given
  double per_source = 0;  // 1 / N_j; 0 where nothing is given
};

// `bright`: what brightness alone makes fireflies, in a compact order. Leaves out those around which
// the bright are even, sets the reach and share of the others, and returns for each of these the
// record numbers of those it gives to, itself among them. Throws Error{interrupted} on ^C.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> find_receivers(const Problem& problem,
                                                                     EngineKind engine,
                                                                     std::vector<Firefly>& bright);

}  // namespace psf::filter
