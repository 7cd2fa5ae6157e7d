// What stands for the reference where there is none.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace psf::study {

// (height, width) the median over the square of 5 x 5 pixels around, as far as it lies in the
// picture. Of a picture without filter, nothing that a filter does is in it, and neither is what a
// rare bright path or the rim of a lamp leaves in fewer than half of the pixels. Values that are
// not finite do not count; 0 where none is.
[[nodiscard]] std::vector<double> median_around(std::span<const double> values, std::size_t width);

}  // namespace psf::study
