// [adaptive]: [average] in the largest ball up to which contributions agree.
#pragma once

#include "filter/estimators/method.h"

namespace psf::filter {

// The result is the same for any engine.
[[nodiscard]] Estimates adaptive(const MethodInput& input);

}  // namespace psf::filter
