// glTF and GLB, by tinygltf: the file, its scene graph and its warnings; the rest is in gltf_*.cpp.
#include <ImathQuat.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "formats/error.h"
#include "render/gltf_parts.h"
#include "render/json_cursor.h"

namespace psf::render {
namespace {

constexpr int kMaxDepth = 512;  // of nodes within nodes

// Keeps the bytes of a picture as they are, to be decoded by OpenImageIO. Those in a buffer view
// are read later, with their bounds checked, which tinygltf does not do; those in files by
// OpenImageIO itself.
bool keep_bytes(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void*) {
  image->as_is = true;
  if (image->bufferView < 0 && image->uri.empty() && size > 0)
    image->image.assign(bytes, bytes + size);
  return true;
}

void parse(GltfLoad& load) {
  const bool binary = [&] {
    std::ifstream file(load.path, std::ios::binary);
    std::array<char, 4> magic{};
    file.read(magic.data(), magic.size());
    return std::string_view(magic.data(), magic.size()) == "glTF";
  }();
  tinygltf::TinyGLTF reader;
  reader.SetImageLoader(keep_bytes, nullptr);
  std::string error, warning;
  bool ok = false;
  try {
    ok = binary ? reader.LoadBinaryFromFile(&load.model, &error, &warning, load.path)
                : reader.LoadASCIIFromFile(&load.model, &error, &warning, load.path);
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  if (ok) return;
  if (!binary) (void)read_json(load.path);  // names line and column where the JSON is malformed
  std::replace(error.begin(), error.end(), '\n', ' ');
  error.erase(error.find_last_not_of(' ') + 1);
  throw Error(ErrorCode::bad_input, fmt::format("{}: not readable as glTF: {}", load.path,
                                                error.empty() ? "it is damaged" : error));
}

void check_extensions(const GltfLoad& load) {
  static constexpr std::string_view kKnown[] = {
      "KHR_lights_punctual",   "KHR_materials_emissive_strength", "KHR_materials_ior",
      "KHR_mesh_quantization", "KHR_materials_transmission",      "KHR_texture_transform"};
  for (const std::string& name : load.model.extensionsRequired) {
    if (std::find(std::begin(kKnown), std::end(kKnown), name) == std::end(kKnown)) {
      load.fail("/extensionsRequired",
                "the file needs " + name + ", which psf does not have; export it without");
    }
  }
}

// In float or double, see Space::exact.
template <class T>
Imath::Matrix44<T> local_matrix(const GltfLoad& load, const tinygltf::Node& node,
                                const std::string& place) {
  const auto sized = [&](const std::vector<double>& v, std::size_t size, const char* key) {
    if (!v.empty() && v.size() != size)
      load.fail(place, fmt::format("\"{}\" has not {} numbers", key, size));
    return !v.empty();
  };
  const auto f = [](double value) { return static_cast<T>(value); };
  using Vector = Imath::Vec3<T>;
  Imath::Matrix44<T> m;
  // glTF stores columns of a matrix for column vectors: the same order as our rows for row vectors.
  if (sized(node.matrix, 16, "matrix")) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = f(node.matrix[static_cast<std::size_t>(i)]);
    return m;
  }
  if (sized(node.scale, 3, "scale"))
    m.setScale(Vector(f(node.scale[0]), f(node.scale[1]), f(node.scale[2])));
  if (sized(node.rotation, 4, "rotation")) {
    const auto& q = node.rotation;
    m *= Imath::Quat<T>(f(q[3]), f(q[0]), f(q[1]), f(q[2])).normalized().toMatrix44();
  }
  if (sized(node.translation, 3, "translation")) {
    const auto& t = node.translation;
    m *= Imath::Matrix44<T>().setTranslation(Vector(f(t[0]), f(t[1]), f(t[2])));
  }
  return m;
}

Imath::M44d world_matrix(const GltfLoad& load, const tinygltf::Node& node,
                         const Imath::M44d& parent, const std::string& place) {
  if (load.scene.space.exact) return local_matrix<double>(load, node, place) * parent;
  return Imath::M44d(local_matrix<float>(load, node, place) * Mat4(parent));
}

void add_node(GltfLoad& load, int index, const Imath::M44d& parent, int depth) {
  const std::string place = fmt::format("/nodes/{}", index);
  if (index < 0 || static_cast<std::size_t>(index) >= load.model.nodes.size())
    load.fail(place, "no such node");
  if (depth > kMaxDepth)
    load.fail(place, fmt::format("more than {} nodes within nodes, or a circle", kMaxDepth));
  const tinygltf::Node& node = load.model.nodes[static_cast<std::size_t>(index)];
  const Imath::M44d to_scene = world_matrix(load, node, parent, place);
  const std::string name = node.name.empty() ? fmt::format("node {}", index) : node.name;
  if (node.skin >= 0) load.warn_once("skins are left out, meshes are as modelled");
  if (node.mesh >= 0) add_gltf_mesh(load, node.mesh, name, to_scene, place);
  if (node.camera >= 0) add_gltf_camera(load, node.camera, name, to_scene, place);
  if (const auto* light = find_extension(node.extensions, "KHR_lights_punctual")) {
    add_gltf_light(load, static_cast<int>(number_or(*light, "light", -1)), to_scene, place);
  }
  for (const int child : node.children) add_node(load, child, to_scene, depth + 1);
}

// The nodes of the scene to show; without scenes, those that are nobody's child.
std::vector<int> root_nodes(const GltfLoad& load) {
  const tinygltf::Model& model = load.model;
  if (!model.scenes.empty()) {
    const int scene = std::max(model.defaultScene, 0);
    if (static_cast<std::size_t>(scene) >= model.scenes.size()) {
      load.fail("/scene", fmt::format("there is no scene {}", scene));
    }
    return model.scenes[static_cast<std::size_t>(scene)].nodes;
  }
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) {
      if (child >= 0 && static_cast<std::size_t>(child) < is_child.size()) {
        is_child[static_cast<std::size_t>(child)] = true;
      }
    }
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

}  // namespace

void GltfLoad::fail(const std::string& place, const std::string& problem) const {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}: {}", path, place, problem));
}

void GltfLoad::warn_once(const std::string& what) {
  const std::string line = path + ": " + what;
  if (std::find(scene.warnings.begin(), scene.warnings.end(), line) == scene.warnings.end()) {
    scene.warnings.push_back(line);
  }
}

void load_gltf(const std::string& path, Scene& scene) {
  GltfLoad load{path, {}, scene, TextureTable(scene), {}, 0, kNone};
  parse(load);
  check_extensions(load);
  add_gltf_materials(load);
  for (const int node : root_nodes(load)) add_node(load, node, scene.space.to_local(), 0);
}

}  // namespace psf::render
