// [disk]: the sum over the area of the ball's disk, as in photon mapping.
#pragma once

#include <vector>

#include "filter/estimators/method.h"

namespace psf::filter {

// By record number: A_j of the sources, 0 for other records. Throws Error{usage} where the block
// has several cameras.
[[nodiscard]] std::vector<float> disk_areas(const Records& records, const Roles& roles,
                                            const Block& block);

[[nodiscard]] Estimates disk(const MethodInput& input);

}  // namespace psf::filter
