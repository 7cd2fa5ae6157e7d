// [control]: c_bar from one half of the sources as control variate of the other half.
#pragma once

#include <cstdint>

#include "filter/estimators/method.h"

namespace psf::filter {

// The whole number next to queries / shaded: one over a record's probability of being shaded.
// Throws Error{bad_input} where the quotient is not near a whole number, so that the probability is
// not known.
[[nodiscard]] std::uint32_t shade_rate(std::uint64_t queries, std::uint64_t shaded);

// c_bar holds c'_i, which may be negative; `neighbors` holds the number of sources of g_i.
[[nodiscard]] Estimates control(const MethodInput& input);

}  // namespace psf::filter
