// [hash]: averages over the cells of a jittered grid instead of balls; no search.
#pragma once

#include "filter/estimators/method.h"

namespace psf::filter {

// After Binder, Fricke and Keller, Massively Parallel Path Space Filtering, 2019; README.md says
// what differs.
[[nodiscard]] Estimates hash(const MethodInput& input);

}  // namespace psf::filter
