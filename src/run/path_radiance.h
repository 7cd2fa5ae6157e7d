// The radiance that a path adds to its pixel, u + alpha c, with the same operations for every
// picture.
#pragma once

#include <cstddef>

#include "core/vec.h"
#include "filter/records.h"

namespace psf::run {

// u of record i; 0 where the records have no u.
[[nodiscard]] inline Rgb unfiltered_of(const filter::Records& records, std::size_t i) {
  return records.unfiltered.empty() ? Rgb(0, 0, 0) : records.unfiltered[i];
}

// u + alpha c; `c` is the contribution or its replacement, c_bar.
[[nodiscard]] inline Rgb path_radiance(const Rgb& u, const Rgb& alpha, const Rgb& c) {
  return {u.x + alpha.x * c.x, u.y + alpha.y * c.y, u.z + alpha.z * c.z};
}

}  // namespace psf::run
