// An order in which neighbours in space are near each other: queries in that order share their
// cache.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::search {

// The chosen points' numbers along a Morton curve through their bounds, ties by number. `chosen`:
// which of the points, in any order; their coordinates are finite.
[[nodiscard]] std::vector<std::uint32_t> curve_order(std::span<const Vec3> points,
                                                     std::span<const std::uint32_t> chosen);

}  // namespace psf::search
