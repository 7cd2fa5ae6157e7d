// Turns the parts of an OBJ file into triangle meshes.
#pragma once

#include <string>
#include <vector>

#include "render/scene/obj/file.h"
#include "render/scene/polygon.h"

namespace psf::render {

class ObjMeshes {
 public:
  // Both arguments must outlive this object.
  ObjMeshes(const std::string& path, const ObjFile& file);

  // Makes the mesh of a part, without name and material. Corners with equal position, uv and normal
  // share a vertex. The mesh has normals where every corner has one.
  [[nodiscard]] Mesh make(const ObjPart& part);
  // Adds one warning to the scene for each kind of odd face that was found.
  void warn(Scene& scene) const;

 private:
  // The odd faces of one kind.
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
  std::vector<std::uint32_t> newest_;  // by position: the newest vertex at this position
  std::vector<std::uint32_t> older_;   // by vertex: the vertex before it at the same position
  std::vector<ObjCorner> corners_;     // by vertex
  std::vector<Vec3> points_;           // corners of one face
  std::vector<std::uint32_t> vertices_;
  bool all_normals_ = true, any_uv_ = false;
  Odd repeating_, crossing_;
};

}  // namespace psf::render
