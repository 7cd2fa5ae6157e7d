// The parts of the glTF loader.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/load_parts.h"
#include "render/scene.h"

namespace psf::render {

// A glTF file while it is read. Errors name the file and a JSON path in it.
struct GltfLoad {
  std::string path;
  tinygltf::Model model;
  Scene& scene;
  TextureTable files;  // pictures that lie beside the file
  std::vector<std::array<int, 2>>
      images;                    // of each image: index in Scene::textures as sRGB and as linear
  int first_material = 0;        // of the file, in Scene::materials
  int default_material = kNone;  // for primitives without one, made when first needed

  [[noreturn]] void fail(const std::string& place, const std::string& problem) const;
  void warn_once(const std::string& what);
};

// The bytes of a buffer view; throws where it reaches outside its buffer.
[[nodiscard]] std::span<const unsigned char> bytes_of(const GltfLoad& load, int buffer_view,
                                                      const std::string& place);
// (count, components) of an accessor as floats; normalised integers become [0, 1] or [-1, 1].
// `components`: what the accessor must have.
[[nodiscard]] std::vector<float> read_floats(const GltfLoad& load, int accessor,
                                             std::size_t components, const std::string& place);
[[nodiscard]] std::vector<std::uint32_t> read_indices(const GltfLoad& load, int accessor,
                                                      const std::string& place);

// An object in the extensions of something, or null.
[[nodiscard]] const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions,
                                                    const char* name);
[[nodiscard]] double number_or(const tinygltf::Value& object, const char* key, double otherwise);

// All materials of the file, in its order, with their textures.
void add_gltf_materials(GltfLoad& load);
// Index in Scene::materials; the default of glTF where the primitive has none.
[[nodiscard]] int gltf_material(GltfLoad& load, int material, const std::string& place);
// The light, camera or triangles of a node; `to_scene`: from the node to the scene's space.
void add_gltf_light(GltfLoad& load, int light, const Imath::M44d& to_scene,
                    const std::string& place);
void add_gltf_camera(GltfLoad& load, int camera, const std::string& name,
                     const Imath::M44d& to_scene, const std::string& place);
void add_gltf_mesh(GltfLoad& load, int mesh, const std::string& name, const Imath::M44d& to_scene,
                   const std::string& place);

}  // namespace psf::render
