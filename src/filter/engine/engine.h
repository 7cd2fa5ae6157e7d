// The fast engine: packets of queries in a compact order walk a tree over the sources.
#pragma once

#include <memory>

#include "filter/problem.h"

namespace psf::filter::engine {

// Finds the same neighbours as plain.h, to the last one. None where values are so large that
// products of them may be no finite floats, which the bounds rely on.
[[nodiscard]] std::unique_ptr<Engine> make(const Problem& problem);

}  // namespace psf::filter::engine
