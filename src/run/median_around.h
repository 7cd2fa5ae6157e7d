// An estimate of the reference for dumps that have none.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace psf::run {

// For each pixel the median over the 5 x 5 pixels around it that lie in the picture, (height,
// width). Values that are not finite do not count; the result is 0 where no value is finite. For a
// picture without filter the median depends on no filter, and rare bright paths and rims of lamps,
// which reach fewer than half of the pixels, are not in it.
[[nodiscard]] std::vector<double> median_around(std::span<const double> values, std::size_t width);

}  // namespace psf::run
