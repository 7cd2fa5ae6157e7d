// Triangles of a glTF file, and where EXT_mesh_gpu_instancing puts them.
#include <ImathQuat.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "render/scene/copies.h"
#include "render/scene/gltf/parts.h"
#include "render/scene/shapes.h"

namespace psf::render {
namespace {

constexpr std::uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

std::vector<std::array<std::uint32_t, 3>> to_triangles(const std::vector<std::uint32_t>& indices,
                                                       std::uint64_t mode) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const std::size_t count = indices.size();
  if (mode == kTriangles) {
    for (std::size_t i = 0; i + 2 < count; i += 3)
      triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  } else if (mode == kStrip) {
    for (std::size_t i = 0; i + 2 < count; ++i) {
      // Every other triangle of a strip is turned.
      triangles.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    }
  } else {
    for (std::size_t i = 1; i + 1 < count; ++i)
      triangles.push_back({indices[0], indices[i], indices[i + 1]});
  }
  return triangles;
}

// The texture coordinates that the primitive's material asks for: KHR_texture_transform scales,
// then turns, then moves, in glTF's texture space (v down).
void read_uvs(GltfLoad& load, const JsonCursor& primitive, Mesh& mesh) {
  GltfCoordinates from;
  if (const auto material = primitive.find("material"))
    from = load.coordinates.at(static_cast<std::size_t>(material->whole()));
  const std::string name = fmt::format("TEXCOORD_{}", from.set);
  const auto accessor = primitive.at("attributes").find(name);
  if (!accessor) return;
  const auto values = read_floats(load, *accessor, 2);
  const float c = std::cos(from.rotation), s = std::sin(from.rotation);
  mesh.uvs.reserve(values.size() / 2);
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) {
    const Vec2 p = Vec2(values[i], values[i + 1]) * from.scale;
    const Vec2 uv = Vec2(c * p.x + s * p.y, c * p.y - s * p.x) + from.offset;
    mesh.uvs.emplace_back(uv.x, 1 - uv.y);
  }
  if (mesh.uvs.size() != mesh.positions.size())
    accessor->fail(name + " and POSITION have different counts");
}

std::vector<Vec3> read_vectors(GltfLoad& load, const JsonCursor& accessor) {
  const auto values = read_floats(load, accessor, 3);
  std::vector<Vec3> vectors;
  vectors.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    vectors.emplace_back(values[i], values[i + 1], values[i + 2]);
  return vectors;
}

// Where a normal map asks for them. Without normals glTF knows none.
void read_tangents(GltfLoad& load, const JsonCursor& primitive, Mesh& mesh) {
  const auto accessor = primitive.at("attributes").find("TANGENT");
  const Material& material = load.scene.materials[static_cast<std::size_t>(mesh.material)];
  if (!accessor || mesh.normals.empty() || mesh.uvs.empty() || material.normal_texture == kNone)
    return;
  const auto values = read_floats(load, *accessor, 4);
  mesh.tangents.reserve(values.size() / 4);
  for (std::size_t i = 0; i + 3 < values.size(); i += 4)
    mesh.tangents.emplace_back(values[i], values[i + 1], values[i + 2], values[i + 3]);
  if (mesh.tangents.size() != mesh.positions.size())
    accessor->fail("TANGENT and POSITION have different counts");
}

void note_attributes(GltfLoad& load, const JsonCursor& primitive) {
  const std::string place = primitive.path();
  if (const auto targets = primitive.find("targets"); targets && targets->size() > 0)
    load.leave_out("morph targets are left out", place);
  for (const std::string& key : primitive.at("attributes").keys()) {
    if (key.starts_with("COLOR_")) load.leave_out("vertex colours are left out", place);
  }
}

void add_primitive(GltfLoad& load, const JsonCursor& primitive, const std::string& name,
                   std::span<const Imath::M44d> placements) {
  load.check_keys(primitive, {"attributes", "indices", "material", "mode", "targets"});
  const JsonCursor attributes = primitive.at("attributes");
  const auto mode_json = primitive.find("mode");
  const std::uint64_t mode = mode_json ? mode_json->whole() : kTriangles;
  if (mode > kFan) mode_json->fail(fmt::format("mode {} is none of glTF's", mode));
  if (mode < kTriangles) return load.leave_out("points and lines are left out", primitive.path());
  note_attributes(load, primitive);
  Mesh mesh;
  mesh.name = name;
  mesh.material = gltf_material(load, primitive);
  const auto positions = attributes.find("POSITION");
  if (!positions)
    return load.leave_out("primitives without positions are left out", primitive.path());
  if (find_extension(primitive, "KHR_draco_mesh_compression") &&
      !load.element("accessors", *positions, "accessor").find("bufferView")) {
    primitive.fail("needs KHR_draco_mesh_compression, which psf does not have; export it without");
  }
  mesh.positions = read_vectors(load, *positions);
  if (const auto normals = attributes.find("NORMAL")) {
    mesh.normals = read_vectors(load, *normals);
    if (mesh.normals.size() != mesh.positions.size())
      normals->fail("NORMAL and POSITION have different counts");
  }
  read_uvs(load, primitive, mesh);
  read_tangents(load, primitive, mesh);

  std::vector<std::uint32_t> indices;
  if (const auto accessor = primitive.find("indices")) {
    indices = read_indices(load, *accessor);
  } else {
    indices.resize(mesh.positions.size());
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
  }
  if (indices.size() < 3 || (mode == kTriangles && indices.size() % 3 != 0))
    load.leave_out("vertices that are too few for a triangle are left out", primitive.path());
  mesh.triangles = to_triangles(indices, mode);
  // What is flattened has the normals of its faces.
  Mesh flat;
  flat.name = name;
  flat.material = mesh.material;
  std::vector<Imath::M44d> whole, flattening;
  for (const Imath::M44d& placement : placements)
    (placement.determinant() == 0 ? flattening : whole).push_back(placement);
  const bool instanced =
      load.tracks.empty() && !whole.empty() && is_instanced(load.scene, mesh, whole);
  load.copies.add(primitive, mesh.triangles.size(), mesh.positions.size(),
                  std::max<std::size_t>(whole.size(), 1), instanced);
  if (!flattening.empty())
    load.copies.add(primitive, mesh.triangles.size(), mesh.positions.size(), flattening.size());
  try {
    if (!whole.empty() && !mesh.positions.empty()) {
      add_copies(load.scene, mesh, whole, true, instanced);
    }
  } catch (const Error& error) {
    primitive.fail("node " + name + ": " + error.what());
  }
  mesh.normals.clear();
  mesh.tangents.clear();
  for (const Imath::M44d& placement : flattening) {
    Mesh copy = mesh;
    for (Vec3& p : copy.positions) p = Vec3(Imath::V3d(p) * placement);
    append(flat, copy);
  }
  if (!flat.positions.empty()) load.scene.meshes.push_back(std::move(flat));
}

}  // namespace

void add_gltf_mesh(GltfLoad& load, const JsonCursor& index, const std::string& name,
                   std::span<const Imath::M44d> placements) {
  const JsonCursor mesh = load.element("meshes", index, "mesh");
  load.check_keys(mesh, {"primitives", "weights"});
  stop_where_interrupted();
  const JsonCursor primitives = mesh.at("primitives");
  if (placements.empty()) return;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    add_primitive(load, primitives.item(i),
                  primitives.size() == 1 ? name : fmt::format("{}/{}", name, i), placements);
  }
}

Imath::M44d gltf_matrix(const Imath::V3d& scale, std::span<const double, 4> rotation,
                        const Imath::V3d& translation) {
  Imath::M44d m;
  m.setScale(scale);
  m *= Imath::Quatd(rotation[3], rotation[0], rotation[1], rotation[2]).normalized().toMatrix44();
  return m * Imath::M44d().setTranslation(translation);
}

std::vector<Imath::M44d> gltf_instances(GltfLoad& load, const JsonCursor& extension) {
  load.check_keys(extension, {"attributes"});
  const JsonCursor attributes = extension.at("attributes");
  std::optional<std::size_t> count;
  const auto read = [&](const char* key, std::size_t components) {
    const auto accessor = attributes.find(key);
    if (!accessor) return std::vector<float>{};
    auto values = read_floats(load, *accessor, components);
    const std::size_t own = values.size() / components;
    if (count.value_or(own) != own) accessor->fail("the attributes have different counts");
    for (const float value : values) {
      if (!std::isfinite(value))
        accessor->fail(std::string(key) + " has numbers that are not finite");
    }
    count = own;
    return values;
  };
  const auto translation = read("TRANSLATION", 3), rotation = read("ROTATION", 4),
             scale = read("SCALE", 3);
  if (count.value_or(1) > kMaxCopies) {
    throw Error(ErrorCode::limit, fmt::format("{}: {} copies are more than psf takes ({})",
                                              extension.where(), *count, kMaxCopies));
  }
  std::vector<Imath::M44d> placements(count.value_or(1));
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const auto vector = [&](const std::vector<float>& values, double otherwise) {
      return values.empty() ? Imath::V3d(otherwise)
                            : Imath::V3d(Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]));
    };
    std::array<double, 4> turn = {0, 0, 0, 1};
    for (std::size_t k = 0; k < 4 && !rotation.empty(); ++k) turn[k] = double{rotation[4 * i + k]};
    placements[i] = gltf_matrix(vector(scale, 1), turn, vector(translation, 0));
  }
  return placements;
}

}  // namespace psf::render
