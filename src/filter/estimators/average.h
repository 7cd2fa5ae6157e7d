// [average]: the mean over the sources in the ball that pass the weights.
#pragma once

#include "filter/estimators/method.h"

namespace psf::filter {

[[nodiscard]] Estimates average(const MethodInput& input);

}  // namespace psf::filter
