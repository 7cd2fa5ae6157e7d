// Values at keys and between them: what the files of all formats say of movement.
#pragma once

#include <ImathQuat.h>

#include <cstddef>
#include <span>

#include "core/vec.h"

namespace psf::render {

// How a value goes from a key to the next.
enum class Easing : std::uint8_t {
  linear,
  step,   // it stays until the next key
  smooth  // 3 t^2 - 2 t^3: it starts and ends at rest
};

// Where a time lies among keys: `share` of the way from `key` to the next one. Before the first key
// it is at the first, behind the last at the last.
struct Between {
  std::size_t key = 0;
  double share = 0;
};
// `times`: at least one, ascending.
[[nodiscard]] Between between(std::span<const double> times, double time);
[[nodiscard]] double eased(Easing easing, double share);

// Scale, then rotation, then translation.
struct Pose {
  Imath::V3d scale{1, 1, 1};
  Imath::Quatd rotation;  // of unit length
  Imath::V3d translation{0, 0, 0};
  // For row vectors, p * m.
  [[nodiscard]] Imath::M44d matrix() const;
};
// Scale and translation in a straight line, the rotation the short way round.
[[nodiscard]] Pose mix(const Pose& a, const Pose& b, double share);

}  // namespace psf::render
