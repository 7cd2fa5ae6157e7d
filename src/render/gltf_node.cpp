// What the nodes of a glTF file carry: triangles, cameras, lights.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/error.h"
#include "render/gltf_parts.h"
#include "render/shapes.h"

namespace psf::render {
namespace {

std::vector<std::array<std::uint32_t, 3>> to_triangles(const std::vector<std::uint32_t>& indices,
                                                       int mode) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const std::size_t count = indices.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    for (std::size_t i = 0; i + 2 < count; i += 3)
      triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
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

// KHR_texture_transform: scale, then rotation, then offset, in glTF's texture space (v down).
void transform_uvs(const tinygltf::Value& extension, std::vector<Vec2>& uvs) {
  const auto pair = [&](const char* key, float otherwise) {
    if (!extension.Has(key)) return Vec2(otherwise);
    const tinygltf::Value& v = extension.Get(key);
    if (!v.IsArray() || v.ArrayLen() != 2) return Vec2(otherwise);
    return Vec2(static_cast<float>(v.Get(0).GetNumberAsDouble()),
                static_cast<float>(v.Get(1).GetNumberAsDouble()));
  };
  const Vec2 offset = pair("offset", 0), scale = pair("scale", 1);
  const auto rotation = static_cast<float>(number_or(extension, "rotation", 0));
  const float c = std::cos(rotation), s = std::sin(rotation);
  for (Vec2& uv : uvs) {
    const Vec2 p = uv * scale;
    uv = Vec2(c * p.x + s * p.y, c * p.y - s * p.x) + offset;
  }
}

// The texture coordinates that the primitive's material asks for.
void read_uvs(GltfLoad& load, const tinygltf::Primitive& primitive, const std::string& place,
              Mesh& mesh) {
  int set = 0;
  const tinygltf::Value* extension = nullptr;
  if (primitive.material >= 0) {
    const tinygltf::Material& material =
        load.model.materials[static_cast<std::size_t>(primitive.material)];
    const auto& pbr = material.pbrMetallicRoughness;
    bool first = true;
    for (const tinygltf::TextureInfo* info :
         {&pbr.baseColorTexture, &pbr.metallicRoughnessTexture, &material.emissiveTexture}) {
      if (info->index < 0) continue;
      const tinygltf::Value* transform = find_extension(info->extensions, "KHR_texture_transform");
      if (first) {
        set = info->texCoord;
        extension = transform;
      } else if (info->texCoord != set || (transform == nullptr) != (extension == nullptr)) {
        load.warn_once("textures of one material share the coordinates of the first");
      }
      first = false;
    }
  }
  const std::string name = fmt::format("TEXCOORD_{}", set);
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end()) return;
  const auto values = read_floats(load, found->second, 2, place + "/attributes/" + name);
  for (std::size_t i = 0; i + 1 < values.size(); i += 2)
    mesh.uvs.emplace_back(values[i], values[i + 1]);
  if (extension) transform_uvs(*extension, mesh.uvs);
  for (Vec2& uv : mesh.uvs) uv.y = 1 - uv.y;
  if (mesh.uvs.size() != mesh.positions.size())
    load.fail(place, name + " and POSITION have different counts");
}

void read_vectors(const GltfLoad& load, const tinygltf::Primitive& primitive, const char* name,
                  const std::string& place, std::vector<Vec3>& out) {
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end()) return;
  const auto values = read_floats(load, found->second, 3, place + "/attributes/" + name);
  out.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    out.emplace_back(values[i], values[i + 1], values[i + 2]);
}

void add_primitive(GltfLoad& load, const tinygltf::Primitive& primitive, const std::string& name,
                   const Imath::M44d& to_scene, const std::string& place) {
  const int mode = primitive.mode == -1 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    return load.warn_once("points and lines are left out");
  }
  if (!primitive.targets.empty()) load.warn_once("morph targets are left out");
  if (primitive.attributes.count("COLOR_0") > 0) load.warn_once("vertex colours are left out");
  Mesh mesh;
  mesh.name = name;
  mesh.material = gltf_material(load, primitive.material, place);
  read_vectors(load, primitive, "POSITION", place, mesh.positions);
  if (mesh.positions.empty()) return load.warn_once("primitives without positions are left out");
  read_vectors(load, primitive, "NORMAL", place, mesh.normals);
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()) {
    load.fail(place, "NORMAL and POSITION have different counts");
  }
  read_uvs(load, primitive, place, mesh);

  std::vector<std::uint32_t> indices;
  if (primitive.indices >= 0) {
    indices = read_indices(load, primitive.indices, place + "/indices");
  } else {
    indices.resize(mesh.positions.size());
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
  }
  mesh.triangles = to_triangles(indices, mode);
  try {
    if (load.scene.space.exact) {
      transform(mesh, to_scene);
    } else {
      transform(mesh, Mat4(to_scene));
    }
  } catch (const Error& error) {
    load.fail(place, error.what());
  }
  load.scene.meshes.push_back(std::move(mesh));
}

// The image of a direction, unit.
Vec3 turn(const Imath::M44d& m, const Vec3& direction) {
  Vec3 turned;
  Mat4(m).multDirMatrix(direction, turned);
  return turned.normalized();
}

Vec3 place_of(const Imath::M44d& m) {
  return Vec3(Imath::V3d(m[3][0], m[3][1], m[3][2]));
}

}  // namespace

void add_gltf_mesh(GltfLoad& load, int index, const std::string& name, const Imath::M44d& to_scene,
                   const std::string& place) {
  if (static_cast<std::size_t>(index) >= load.model.meshes.size()) {
    load.fail(place, fmt::format("there is no mesh {}", index));
  }
  const tinygltf::Mesh& mesh = load.model.meshes[static_cast<std::size_t>(index)];
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    const std::string part = mesh.primitives.size() == 1 ? name : fmt::format("{}/{}", name, i);
    add_primitive(load, mesh.primitives[i], part, to_scene,
                  fmt::format("/meshes/{}/primitives/{}", index, i));
  }
}

void add_gltf_camera(GltfLoad& load, int index, const std::string& name,
                     const Imath::M44d& to_scene, const std::string& place) {
  if (static_cast<std::size_t>(index) >= load.model.cameras.size()) {
    load.fail(place, fmt::format("there is no camera {}", index));
  }
  const tinygltf::Camera& gltf = load.model.cameras[static_cast<std::size_t>(index)];
  if (gltf.type != "perspective") return load.warn_once("orthographic cameras are left out");
  const double aspect = gltf.perspective.aspectRatio > 0 ? gltf.perspective.aspectRatio : 1.0;
  Camera camera;
  camera.name = gltf.name.empty() ? name : gltf.name;
  camera.eye = place_of(to_scene);
  camera.target = camera.eye + turn(to_scene, {0, 0, -1});
  camera.up = turn(to_scene, {0, 1, 0});
  camera.fov = static_cast<float>(2 * std::atan(std::tan(gltf.perspective.yfov / 2) * aspect));
  camera.height =
      static_cast<std::uint32_t>(std::lround(std::clamp(camera.width / aspect, 1.0, 65536.0)));
  load.scene.cameras.push_back(std::move(camera));
}

void add_gltf_light(GltfLoad& load, int index, const Imath::M44d& to_scene,
                    const std::string& place) {
  if (index < 0 || static_cast<std::size_t>(index) >= load.model.lights.size()) {
    load.fail(place, fmt::format("there is no light {}", index));
  }
  const tinygltf::Light& gltf = load.model.lights[static_cast<std::size_t>(index)];
  Light light;
  light.name = gltf.name.empty() ? fmt::format("light {}", index) : gltf.name;
  light.position = place_of(to_scene);
  light.direction = turn(to_scene, {0, 0, -1});
  const auto color = [&](std::size_t i) { return i < gltf.color.size() ? gltf.color[i] : 1.0; };
  for (int i = 0; i < 3; ++i) {
    light.intensity[i] = static_cast<float>(color(static_cast<std::size_t>(i)) * gltf.intensity);
  }
  if (gltf.type == "directional") {
    light.kind = LightKind::directional;
  } else if (gltf.type == "spot") {
    light.kind = LightKind::spot;
    const double outer = std::clamp(gltf.spot.outerConeAngle, 1e-4, std::numbers::pi / 2);
    light.cos_inner =
        static_cast<float>(std::cos(std::clamp(gltf.spot.innerConeAngle, 0.0, outer)));
    light.cos_outer = static_cast<float>(std::cos(outer));
  } else if (gltf.type != "point") {
    load.fail(place, fmt::format("light {} is of the unknown type \"{}\"", index, gltf.type));
  }
  load.scene.lights.push_back(std::move(light));
}

}  // namespace psf::render
