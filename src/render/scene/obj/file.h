// The content of an OBJ file, before it is turned into materials and triangles.
#pragma once

#include <ImathBox.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace psf::render {

class LeftOut;

// One corner of a face: places in the arrays of ObjFile.
struct ObjCorner {
  static constexpr std::uint32_t kNo = 0xFFFFFFFF;
  std::uint32_t position = kNo, uv = kNo, normal = kNo;
  bool operator==(const ObjCorner&) const = default;
};

struct ObjFace {
  std::size_t first = 0;  // first corner, in ObjFile::corners
  std::uint32_t corners = 0;
  std::uint32_t line = 0;
};

// The faces of one object (or group) that have one material.
struct ObjPart {
  std::string object;
  std::string material;  // empty: no material
  std::size_t line = 0;  // line of its first face
  std::vector<ObjFace> faces;
};

struct ObjFile {
  std::vector<Vec3> positions, normals;  // positions are in the `space` of read_obj()
  Imath::Box3d bounds;                   // bounds of all positions, in world units
  std::vector<Vec2> uvs;
  std::vector<ObjCorner> corners;
  std::vector<ObjPart> parts;  // in the order of their first faces, none empty
  struct Libraries {
    std::string names;  // the text of one mtllib line
    std::size_t line = 0;
  };
  std::vector<Libraries> libraries;
};

// Reads every statement and checks its numbers and indices. Statements without effect are added to
// `left_out`. Throws Error{bad_input} naming file and line, Error{io} where the file cannot be
// read.
[[nodiscard]] ObjFile read_obj(const std::string& path, const Space& space, LeftOut& left_out);

}  // namespace psf::render
