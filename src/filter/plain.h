// The plain engine: one neighbour search per query, and one loop over the neighbours.
#pragma once

#include <memory>

#include "filter/problem.h"

namespace psf::filter {

// `kind`: plain or brute.
[[nodiscard]] std::unique_ptr<Engine> make_plain(EngineKind kind, const Problem& problem);

}  // namespace psf::filter
