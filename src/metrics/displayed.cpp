#include "metrics/displayed.h"

#include <cmath>

#include "film/display.h"

namespace psf::metrics {

Displayed displayed(std::span<const Rgb> picture, std::size_t width, float exposure) {
  const Plane plane(width, picture.size() / width);
  Displayed result = {plane, plane, plane};
  const float scale = std::exp2(exposure);
  for_pixels(plane, [&](std::size_t y, std::size_t x) {
    const Rgb& color = picture[y * width + x];
    for (unsigned k = 0; k < 3; ++k) {
      result[k].row(y)[x] = film::tone_map(color[static_cast<int>(k)] * scale);
    }
  });
  return result;
}

}  // namespace psf::metrics
