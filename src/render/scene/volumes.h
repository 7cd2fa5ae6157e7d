// Which media between the surfaces a scene uses.
#pragma once

#include <string>

#include "render/scene/scene.h"

namespace psf::render {

// The medium that is everywhere, or else the first shape that is a volume, in words for a message;
// empty where paths are scattered at surfaces and in bodies alone. A material that no shape has
// does not count.
[[nodiscard]] std::string volume_in_use(const Scene& scene);

}  // namespace psf::render
