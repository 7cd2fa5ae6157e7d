// Parts of an OBJ file to meshes of triangles.
#pragma once

#include <string>
#include <vector>

#include "render/obj_file.h"
#include "render/polygon.h"

namespace psf::render {

class ObjMeshes {
 public:
  // Both must outlive it.
  ObjMeshes(const std::string& path, const ObjFile& file);

  // Corners that agree in all share a vertex; normals are there where every corner has one. Name
  // and material stay empty.
  [[nodiscard]] Mesh make(const ObjPart& part);
  // One warning for each kind of odd face that came up.
  void warn(Scene& scene) const;

 private:
  // Faces of some kind.
  struct Odd {
    std::size_t count = 0, first_line = 0;
    void add(const ObjFace& face) {
      if (count++ == 0) first_line = face.line;
    }
  };
  void add(const ObjFace& face, Mesh& mesh);
  std::uint32_t vertex(const ObjCorner& corner, Mesh& mesh);
  static std::uint32_t blend(const Crossing& crossing, const std::vector<std::uint32_t>& vertices,
                             Mesh& mesh);

  const std::string& path_;
  const ObjFile& file_;
  PolygonCutter cutter_;
  std::vector<std::uint32_t> newest_;  // by position, of the mesh's vertices there
  std::vector<std::uint32_t> older_;   // by vertex, the one before it at its position
  std::vector<ObjCorner> corners_;     // by vertex
  std::vector<Vec3> points_;           // of one face
  std::vector<std::uint32_t> vertices_;
  bool all_normals_ = true, any_uv_ = false;
  Odd repeating_, crossing_;
};

}  // namespace psf::render
