// One block of one camera, filtered at the radii that the parameters give.
#pragma once

#include <vector>

#include "filter/average.h"
#include "filter/radius.h"
#include "record_set.h"

namespace psf::tests {

inline const std::vector<filter::CameraView> kCamera = {{30, 30, 0.05}};

inline filter::Average run_average(const RecordSet& set, const filter::Parameters& parameters,
                                   double n = 1) {
  const filter::Block block{0, n, 1, kCamera};
  std::vector<float> radius;
  filter::radii(parameters.radius, set.view(), block, radius);
  return filter::average(set.view(), radius, block, parameters);
}

}  // namespace psf::tests
