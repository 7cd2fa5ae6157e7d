// An order in which points that follow each other are near each other, in groups with small boxes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::search {

// Points a group, groups a group of groups, and so on.
inline constexpr std::size_t kGroup = 16;

// The chosen points' numbers: cut across the longest side of their box into four parts, each of
// these again, and so on down to groups, of which only the last is ever short. So runs of 16, 256
// and 4,096 of them are compact. Along a Morton curve they bend around corners and leap, and up to
// twice as many of them are near a ball; along a Hilbert curve up to a third more (filter/README.md,
// "Speed").
// `chosen`: which of the points, in any order; their coordinates are finite.
[[nodiscard]] std::vector<std::uint32_t> compact_order(std::span<const Vec3> points,
                                                       std::span<const std::uint32_t> chosen);

}  // namespace psf::search
