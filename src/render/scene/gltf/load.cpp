// glTF and GLB: the scene graph; the rest is in gltf_*.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "render/scene/gltf/parts.h"

namespace psf::render {
namespace {

constexpr int kMaxNodeDepth = 512;  // deepest nesting of nodes

Imath::M44d local_matrix(const GltfLoad& load, const JsonCursor& node, std::uint64_t index) {
  if (const auto matrix = node.find("matrix")) {
    if (load.tracks.contains(index))
      matrix->fail(
          "a node that an animation moves has no matrix; export it with a translation, "
          "rotation and scale");
    // glTF stores columns of a matrix for column vectors: the same order as our rows for row
    // vectors.
    const auto v = matrix->numbers(16);
    if (v[3] != 0 || v[7] != 0 || v[11] != 0 || v[15] != 1)
      matrix->fail("the last row of a matrix is 0, 0, 0, 1 (column by column)");
    Imath::M44d m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = v[static_cast<std::size_t>(i)];
    return m;
  }
  const auto scale = node.find("scale"), rotation = node.find("rotation"),
             translation = node.find("translation");
  GltfNodePose pose;
  if (rotation) {
    const auto v = rotation->numbers(4);
    std::copy(v.begin(), v.end(), pose.rotation.begin());
    if (pose.rotation == std::array<double, 4>{})
      rotation->expected("a quaternion, four numbers that are not all zero");
  }
  if (scale) pose.scale = scale->vec3d();
  if (translation) pose.translation = translation->vec3d();
  animate_node(load, index, pose);
  return gltf_matrix(pose.scale, pose.rotation, pose.translation);
}

// Whether all of a node is in one point.
bool is_point(const Imath::M44d& m) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (m[i][k] != 0) return false;
    }
  }
  return true;
}

bool is_hidden(GltfLoad& load, const JsonCursor& node) {
  const auto extension = find_extension(node, "KHR_node_visibility");
  if (!extension) return false;
  load.check_keys(*extension, {"visible"});
  const auto visible = extension->find("visible");
  return visible && !visible->boolean();
}

void add_node(GltfLoad& load, const JsonCursor& index, const Imath::M44d& parent, int depth) {
  const JsonCursor node = load.element("nodes", index, "node");
  if (depth > kMaxNodeDepth)
    node.fail(fmt::format("more than {} nodes within nodes, or a circle", kMaxNodeDepth));
  if (!load.nodes.insert(index.whole()).second)
    index.fail(fmt::format("node {} is in the scene twice; glTF has a tree of nodes, copy it",
                           index.whole()));
  stop_where_interrupted();
  load.check_keys(node, {"camera", "children", "skin", "matrix", "mesh", "rotation", "scale",
                         "translation", "weights"});
  if (is_hidden(load, node)) return;
  const Imath::M44d to_scene = local_matrix(load, node, index.whole()) * parent;
  if (is_point(to_scene))
    return load.leave_out("nodes scaled to nothing are left out", gltf_place(node));
  const auto number = static_cast<std::size_t>(index.whole());
  const std::string name = gltf_name(node, "node", number);
  if (node.find("skin"))
    load.leave_out("skins are left out, meshes are as modelled", gltf_place(node));
  const bool alone = load.scene.moment.parts == Moment::Parts::cameras;
  if (const auto mesh = node.find("mesh"); mesh && !alone) {
    std::vector<Imath::M44d> placements{to_scene};
    if (const auto instancing = find_extension(node, "EXT_mesh_gpu_instancing")) {
      placements = gltf_instances(load, *instancing);
      for (Imath::M44d& m : placements) m = m * to_scene;
    }
    add_gltf_mesh(load, *mesh, name, placements);
  }
  if (const auto camera = node.find("camera")) add_gltf_camera(load, *camera, name, to_scene);
  if (const auto light = find_extension(node, "KHR_lights_punctual"))
    add_gltf_light(load, light->at("light"), to_scene);
  for (const JsonCursor& child : node.items("children")) add_node(load, child, to_scene, depth + 1);
}

// Calls add(index) for the nodes of the scene to show; without scenes, for those that are nobody's
// child.
template <typename Add>
void each_root(GltfLoad& load, Add add) {
  const JsonCursor root = load.root();
  const auto scenes = root.find("scenes");
  if (scenes && scenes->size() > 0) {
    const auto chosen = root.find("scene");
    const std::size_t index = chosen ? static_cast<std::size_t>(chosen->whole()) : 0;
    if (index >= scenes->size()) chosen->fail(fmt::format("there is no scene {}", index));
    if (scenes->size() > 1)
      load.leave_out("scenes are left out but for that of \"scene\", or the first",
                     fmt::format("{} of {}", scenes->size() - 1, scenes->size()));
    const JsonCursor scene = scenes->item(index);
    load.check_keys(scene, {"nodes"});
    for (const JsonCursor& node : scene.items("nodes")) add(node);
    return;
  }
  const auto nodes = root.items("nodes");
  std::vector<bool> is_child(nodes.size());
  for (const JsonCursor& node : nodes) {
    for (const JsonCursor& child : node.items("children")) {
      const std::uint64_t i = child.whole();
      if (i < is_child.size()) is_child[static_cast<std::size_t>(i)] = true;
    }
  }
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (is_child[i]) continue;
    const nlohmann::json index = i;
    add(JsonCursor(index, load.path));
  }
}

}  // namespace

void load_gltf(const std::string& path, Scene& scene) {
  GltfLoad load(path, scene);
  read_gltf_file(load);
  const JsonCursor root = load.root();
  load.check_keys(root, {"accessors", "animations", "asset", "buffers", "bufferViews", "cameras",
                         "extensionsUsed", "extensionsRequired", "images", "materials", "meshes",
                         "nodes", "samplers", "scene", "scenes", "skins", "textures"});
  check_gltf_extensions(load);
  read_gltf_animations(load);
  add_gltf_materials(load);
  each_root(load, [&](const JsonCursor& node) { add_node(load, node, scene.space.to_local(), 0); });
  load.tell();
}

}  // namespace psf::render
