// Adoption of orphans in the fast engine: balls that grow find the nearest sources that pass.
#pragma once

#include <cstdint>

#include "filter/engine/tree.h"
#include "filter/orphans.h"
#include "search/box_index.h"

namespace psf::filter::engine {

// Returns the same as adopt() of orphans.h, for the orphan i with radius r_i. `index` holds the
// boxes of the tree's parents.
[[nodiscard]] Adopted adopt(const Tree& tree, const search::BoxIndex& index, const Problem& problem,
                            std::uint32_t i, float r_i);

}  // namespace psf::filter::engine
