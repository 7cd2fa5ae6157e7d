// What theory says of the error of a set of parameters after n passes, up to constants.
#pragma once

#include <cstdint>

#include "filter/parameters.h"
#include "study/dump.h"

namespace psf::study {

// Proportional to bias^2 where c is smooth, to bias^2 across an edge that no weight handles (both
// while r is much larger than a pixel) and to the variance while balls hold many records. A picture
// keeps its early blocks, with their larger radii, so that the slopes reach n^(-2 delta),
// n^(-delta/2) and n^-(1 - delta) of the design only as n grows.
struct Theory {
  double bias_sq_smooth = 0, bias_sq_edge = 0, variance = 0;
};

// After the first n passes of the dump, in the blocks that they then make.
[[nodiscard]] Theory theory(const Dump& dump, const filter::Parameters& parameters,
                            std::uint64_t n);

// The share of a disk of radius 1 that lies right of a line at -s from its centre.
[[nodiscard]] double share_right(double s);

}  // namespace psf::study
