// [fit] of one path, source by source.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "explain/explain.h"
#include "filter/records.h"

namespace psf::explain {

struct FitSource {
  std::uint32_t record = 0;
  Rgb value{0, 0, 0};  // what is averaged
};

struct PathFit {
  ExplainedFit of;            // its mean not yet multiplied by rho_i
  Colour value{0, 0, 0};      // the fit, likewise
  std::vector<float> beside;  // ExplainedPair::beside, by source
};

// The fit of record i over the sources in its ball, in double, from its equations; none where it is
// their mean. `records` and `r_i` are in one unit of length.
[[nodiscard]] std::optional<PathFit> fit_path(const filter::Records& records, std::uint32_t i,
                                              float r_i, std::span<const FitSource> sources);

}  // namespace psf::explain
