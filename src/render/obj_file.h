// What an OBJ file says, before materials and triangles are made of it.
#pragma once

#include <ImathBox.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/scene.h"

namespace psf::render {

class LeftOut;

// One corner of a face: places in the arrays of ObjFile.
struct ObjCorner {
  static constexpr std::uint32_t kNo = 0xFFFFFFFF;
  std::uint32_t position = kNo, uv = kNo, normal = kNo;
  bool operator==(const ObjCorner&) const = default;
};

struct ObjFace {
  std::size_t first = 0;  // of ObjFile::corners
  std::uint32_t corners = 0;
  std::uint32_t line = 0;
};

// The faces of one object (or group) that have one material.
struct ObjPart {
  std::string object;
  std::string material;  // empty for none
  std::size_t line = 0;  // of its first face
  std::vector<ObjFace> faces;
};

struct ObjFile {
  std::vector<Vec3> positions, normals;  // positions in the space that they are read for
  Imath::Box3d bounds;                   // of all positions, in the world
  std::vector<Vec2> uvs;
  std::vector<ObjCorner> corners;
  std::vector<ObjPart> parts;  // in the order of their first faces, none empty
  struct Libraries {
    std::string names;  // of one mtllib line
    std::size_t line = 0;
  };
  std::vector<Libraries> libraries;
};

// Every statement, its numbers and indices checked where they stand; what becomes nothing is added
// to `left_out`. Throws Error{bad_input} naming file and line, Error{io} where it cannot be read.
[[nodiscard]] ObjFile read_obj(const std::string& path, const Space& space, LeftOut& left_out);

}  // namespace psf::render
