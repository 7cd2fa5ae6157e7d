// An order in which points that follow each other are near each other, in groups with small boxes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace psf::search {

// The number of points in a group, of groups in a group of groups, and so on.
inline constexpr std::size_t kGroup = 16;

// The numbers of the chosen points in a compact order: the points are cut across the longest side
// of their box into four parts, each part is cut again, and so on down to groups, of which only the
// last may be short. So runs of 16, 256 and 4,096 points are compact. Along a Morton curve such
// runs bend around corners and leap, and up to twice as many of them are near a ball; along a
// Hilbert curve it is up to a third more (filter/README.md, "Speed"). `chosen`: numbers of points,
// in any order; the coordinates of these points are finite.
[[nodiscard]] std::vector<std::uint32_t> compact_order(std::span<const Vec3> points,
                                                       std::span<const std::uint32_t> chosen);

}  // namespace psf::search
