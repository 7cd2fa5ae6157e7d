// Orphans of the fast engine: the nearest sources that pass, found by balls that grow.
#pragma once

#include <cstdint>

#include "filter/engine/tree.h"
#include "filter/orphans.h"
#include "search/box_index.h"

namespace psf::filter::engine {

// The same as adopt() of orphans.h, for a radius r_i. `index`: over the nodes of the tree's upper
// level.
[[nodiscard]] Adopted adopt(const Tree& tree, const search::BoxIndex& index, const Problem& problem,
                            std::uint32_t i, float r_i);

}  // namespace psf::filter::engine
