// The parts that load_scene is made of; nothing outside the loaders needs them.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "render/load.h"
#include "render/scene.h"
#include "render/texture.h"

namespace psf::render {

// Most triangles and spheres of a scene, copies of "repeat" included.
constexpr std::size_t kMaxPrimitives = std::size_t{1} << 27;
// Most copies of one shape.
constexpr std::size_t kMaxCopies = std::size_t{1} << 22;

// Loads each picture once, whatever the number of materials that want it.
class TextureTable {
 public:
  explicit TextureTable(Scene& scene) : scene_(scene) {}
  // Index in Scene::textures. `file` is relative to the folder of `scene_file`; where that name
  // does not exist, backslashes and another case are tried, as scenes from other systems have them.
  // The error of a picture that cannot be had starts with `wanted_by`, "room.json:
  // /materials/2/reflectance_map".
  int load(const std::string& scene_file, const std::string& file, ColorSpace color_space,
           const std::string& wanted_by);

 private:
  Scene& scene_;
  std::map<std::pair<std::string, ColorSpace>, int> known_;
};

// `file` relative to the folder of `beside`, see TextureTable::load; unchanged where nothing like
// it exists.
[[nodiscard]] std::string find_file(const std::string& beside, const std::string& file);

// Each adds to the scene what its kind of file describes.
void load_json(const std::string& path, Scene& scene);
void load_obj(const std::string& path, Scene& scene);
void load_gltf(const std::string& path, Scene& scene);
// One of the latter two by extension; throws Error{bad_input} for any other.
void load_mesh_file(const std::string& path, Scene& scene);

// Adds a camera that sees everything where the scene has none, then applies the command line's
// changes. Throws Error{usage} naming the option for values that make no sense.
void apply_overrides(const SceneOverrides& overrides, Scene& scene);

// Drops what cannot be rendered with a warning (triangles without area, zero normals), throws
// Error{bad_input} naming mesh and vertex, material, light or camera for what would spoil the
// picture. `path` is the scene file.
void validate(const std::string& path, Scene& scene);

// Hexadecimal, 32 digits, over everything that shapes the picture; names do not count.
[[nodiscard]] std::string hash_of(const Scene& scene);

}  // namespace psf::render
