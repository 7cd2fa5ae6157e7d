#include "filter/estimators/average.h"

namespace psf::filter {

Estimates average(const MethodInput& input) {
  return apply_engine(input, {.engine = ball_engine});
}

}  // namespace psf::filter
