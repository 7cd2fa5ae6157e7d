// What the sources of the library share: its types as those of the folders behind it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "film/image.h"
#include "filter/parameters/text.h"
#include "psf/parameters.h"
#include "psf/passes.h"
#include "psf/picture.h"
#include "run/passes.h"

namespace psf {

[[nodiscard]] run::PassSelection to_run(const Passes& passes);

// Throws Error{usage} where the values do not go together.
[[nodiscard]] filter::Parameters to_filter(const Parameters& parameters);

[[nodiscard]] Picture to_picture(film::Image image, const std::string& camera);
// The colours of a picture, (height, width).
[[nodiscard]] std::vector<Rgb> colors_of(const Picture& picture);

}  // namespace psf
