// Counts the triangles and spheres of a scene file's shapes, with all their copies.
#pragma once

#include <cstddef>

#include "render/scene/json/cursor.h"

namespace psf::render {

class CopyCount {
 public:
  // Counts `copies` of a shape, which become one mesh, or instances, each of which counts as a
  // triangle. Throws Error{limit} that names `place` where the scene has more triangles and
  // spheres, or the mesh more vertices, than is allowed.
  void add(const JsonCursor& place, std::size_t primitives, std::size_t vertices,
           std::size_t copies, bool instanced = false);

 private:
  std::size_t primitives_ = 0;
};

}  // namespace psf::render
