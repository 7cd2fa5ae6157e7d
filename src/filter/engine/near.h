// Lists of near queries by the fast engine: packets of centres walk a tree over the queries.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "filter/lists.h"

namespace psf::filter::engine {

// As make_lists() of lists.h; null where values are so large that products of them may not be finite.
[[nodiscard]] std::unique_ptr<Lists> make_lists(const Problem& problem,
                                                std::span<const std::uint32_t> centers,
                                                std::span<const float> reach);

}  // namespace psf::filter::engine
