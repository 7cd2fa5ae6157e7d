// The fast engine: packets of queries in a compact order walk a tree over the sources.
#pragma once

#include <memory>

#include "filter/problem.h"

namespace psf::filter::engine {

// An engine that finds exactly the neighbours that plain.h finds. Returns null where values are so
// large that products of them may not be finite floats; the bounds rely on finite products.
[[nodiscard]] std::unique_ptr<Engine> make(const Problem& problem);

}  // namespace psf::filter::engine
