// The error that theory predicts for a set of parameters after n passes, up to constants.
#pragma once

#include <cstdint>

#include "filter/parameters/parameters.h"
#include "run/dump.h"

namespace psf::study {

// Numbers proportional to bias^2 where c is smooth, to bias^2 across an edge that no weight handles
// (both while r is much larger than a pixel), and to the variance while balls hold many records.
// Early blocks, with their larger radii, stay in the picture, so the slopes approach n^(-2 delta),
// n^(-delta/2) and n^-(1 - delta) only as n grows.
struct Theory {
  double bias_sq_smooth = 0, bias_sq_edge = 0, variance = 0;
};

// The prediction for the first n passes of the dump, in the blocks of a run over these passes.
[[nodiscard]] Theory theory(const run::Dump& dump, const filter::Parameters& parameters,
                            std::uint64_t n);

// The share of a unit disk around 0 that lies right of the line x = -s.
[[nodiscard]] double share_right(double s);

}  // namespace psf::study
