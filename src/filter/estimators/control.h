// [control]: c_bar of one half of the sources as control variate of the other.
#pragma once

#include <cstdint>
#include <span>

#include "filter/average.h"

namespace psf::filter {

// K_file, the whole number that the share of shaded records is one over. Throws Error{bad_input}
// where it is near none, so that no record's probability of being shaded is known.
[[nodiscard]] std::uint32_t shade_rate(std::uint64_t queries, std::uint64_t shaded);

// What average() returns for this estimator: c_bar holds c'_i, which may be negative; neighbors are
// the sources of g_i.
[[nodiscard]] Average control(const Records& records, std::span<const float> radius,
                              const Block& block, const Parameters& parameters);

}  // namespace psf::filter
