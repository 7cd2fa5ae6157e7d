// How much of a scene file's shapes there is, with all their copies.
#pragma once

#include <cstddef>

#include "render/json_cursor.h"

namespace psf::render {

class CopyCount {
 public:
  // Counts `copies` of a shape, which become one. Throws Error{limit} naming `place` for more
  // triangles and spheres than a scene takes, or more vertices than a mesh does.
  void add(const JsonCursor& place, std::size_t primitives, std::size_t vertices,
           std::size_t copies);

 private:
  std::size_t primitives_ = 0;
};

}  // namespace psf::render
