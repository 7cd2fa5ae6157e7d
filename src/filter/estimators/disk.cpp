#include "filter/estimators/disk.h"

#include "core/error.h"
#include "filter/values.h"

namespace psf::filter {

std::vector<float> disk_areas(const Records& records, const Roles& roles, const Block& block) {
  if (block.cameras.size() > 1) {
    throw Error(ErrorCode::usage,
                "`estimator disk` counts a surface once for every camera that sees it: "
                "it needs a dump of one camera");
  }
  std::vector<float> area(records.size());
  for (const std::uint32_t j : roles.sources) {
    area[j] = static_cast<float>(surface_area(block.cameras[0].angle_per_pixel,
                                              double{records.distance[j]}, records.normal[j],
                                              records.direction[j], block.samples_per_pixel));
  }
  return area;
}

Estimates disk(const MethodInput& input) {
  return apply_engine(input, {.areas = disk_areas, .engine = ball_engine});
}

}  // namespace psf::filter
