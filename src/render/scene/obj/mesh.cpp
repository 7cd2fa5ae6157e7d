#include "render/scene/obj/mesh.h"

#include <fmt/format.h>

#include "core/error.h"

namespace psf::render {

ObjMeshes::ObjMeshes(const std::string& path, const ObjFile& file)
    : path_(path), file_(file), newest_(file.positions.size(), ObjCorner::kNo) {}

Mesh ObjMeshes::make(const ObjPart& part) {
  Mesh mesh;
  corners_.clear();
  older_.clear();
  all_normals_ = true;
  any_uv_ = false;
  for (const ObjFace& face : part.faces) add(face, mesh);
  // Parts are many and positions too, so only those are reset that this part had.
  for (const ObjCorner& corner : corners_) {
    if (corner.position != ObjCorner::kNo) newest_[corner.position] = ObjCorner::kNo;
  }
  if (!all_normals_) mesh.normals.clear();
  if (!any_uv_) mesh.uvs.clear();
  return mesh;
}

void ObjMeshes::add(const ObjFace& face, Mesh& mesh) {
  points_.clear();
  vertices_.clear();
  for (std::uint32_t i = 0; i < face.corners; ++i) {
    const ObjCorner& corner = file_.corners[face.first + i];
    points_.push_back(file_.positions[corner.position]);
    vertices_.push_back(vertex(corner, mesh));
  }
  if (!cutter_.cut(points_)) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}:{}: the face crosses itself too often to be cut into triangles",
                            path_, face.line));
  }
  if (cutter_.repeats() && face.corners > 3) repeating_.add(face);
  if (!cutter_.crossings().empty()) crossing_.add(face);
  for (const Crossing& crossing : cutter_.crossings())
    vertices_.push_back(blend(crossing, vertices_, mesh));
  corners_.resize(mesh.positions.size());
  older_.resize(mesh.positions.size(), ObjCorner::kNo);
  for (const auto& [a, b, c] : cutter_.triangles())
    mesh.triangles.push_back({vertices_[a], vertices_[b], vertices_[c]});
}

std::uint32_t ObjMeshes::vertex(const ObjCorner& corner, Mesh& mesh) {
  std::uint32_t& newest = newest_[corner.position];
  for (std::uint32_t v = newest; v != ObjCorner::kNo; v = older_[v]) {
    if (corners_[v] == corner) return v;
  }
  const auto next = static_cast<std::uint32_t>(mesh.positions.size());
  corners_.push_back(corner);
  older_.push_back(newest);
  newest = next;
  mesh.positions.push_back(file_.positions[corner.position]);
  const bool has_normal = corner.normal != ObjCorner::kNo, has_uv = corner.uv != ObjCorner::kNo;
  mesh.normals.push_back(has_normal ? file_.normals[corner.normal] : Vec3(0, 0, 0));
  mesh.uvs.push_back(has_uv ? file_.uvs[corner.uv] : Vec2(0, 0));
  all_normals_ = all_normals_ && has_normal;
  any_uv_ = any_uv_ || has_uv;
  return next;
}

// A new vertex where edges cross.
std::uint32_t ObjMeshes::blend(const Crossing& crossing, const std::vector<std::uint32_t>& vertices,
                               Mesh& mesh) {
  Vec3 normal(0, 0, 0);
  Vec2 uv(0, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    if (crossing.weights[i] == 0) continue;
    const std::uint32_t v = vertices[crossing.corners[i]];
    normal += mesh.normals[v] * crossing.weights[i];
    uv += mesh.uvs[v] * crossing.weights[i];
  }
  mesh.positions.push_back(crossing.position);
  mesh.normals.push_back(normal);
  mesh.uvs.push_back(uv);
  return static_cast<std::uint32_t>(mesh.positions.size()) - 1;
}

void ObjMeshes::warn(Scene& scene) const {
  const auto say = [&](const Odd& odd, const char* what) {
    if (odd.count == 0) return;
    scene.warnings.push_back(fmt::format("{}:{}: {} face{} {}", path_, odd.first_line, odd.count,
                                         odd.count == 1 ? "" : "s", what));
  };
  say(repeating_, "with a corner twice in a row, which counts once");
  say(crossing_, "crossing over, drawn wherever its outline goes around");
}

}  // namespace psf::render
