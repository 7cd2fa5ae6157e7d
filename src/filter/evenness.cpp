#include "filter/evenness.h"

#include <cmath>

namespace psf::filter {
namespace {

// T_j is about chi-squared with three degrees of freedom where all is even, and then above this
// once in 140. Measured in README.md, "Fireflies".
constexpr double kLargestEven = 12;

}  // namespace

void Evenness::add(const Vec3& offset, bool is_bright) {
  std::int64_t place[3], square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] = std::lrint(offset[axis] * steps_);
    square += place[axis] * place[axis];
  }
  const std::int64_t u = square / static_cast<std::int64_t>(kSteps);
  const auto add_to = [&](Moments& moments) {
    ++moments.count;
    moments.u += u;
    moments.u_sq += u * u / static_cast<std::int64_t>(kSteps);
    for (int axis = 0; axis < 3; ++axis) moments.o[axis] += place[axis];
  };
  add_to(all_);
  if (is_bright) add_to(bright_);
}

bool Evenness::is_even() const {
  double shift = 0, center = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = all_.mean(all_.o[axis]), apart = bright_.mean(bright_.o[axis]) - o;
    shift += apart * apart;
    center += o * o;
  }
  const double u = all_.mean(all_.u), apart = bright_.mean(bright_.u) - u;
  const double variance_o = (u - center) / 2, variance_u = all_.mean(all_.u_sq) - u * u;
  const double t = shift / variance_o + apart * apart / variance_u;
  return static_cast<double>(bright_.count) * t < kLargestEven;
}

}  // namespace psf::filter
