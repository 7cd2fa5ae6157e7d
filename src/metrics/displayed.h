// A picture as a screen shows it, as input of the metrics that imitate the eye.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/vec.h"
#include "metrics/plane.h"

namespace psf::metrics {

// The linear R, G, B of the screen in [0, 1]: the picture times 2^exposure through tone_map() of
// film/display.h, not rounded to 8 bits.
using Displayed = std::array<Plane, 3>;

[[nodiscard]] Displayed displayed(std::span<const Rgb> picture, std::size_t width, float exposure);

}  // namespace psf::metrics
