// The parts of the glTF loader.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/scene/copy_count.h"
#include "render/scene/json/cursor.h"
#include "render/scene/load_parts.h"
#include "render/scene/scene.h"

namespace psf::render {

// The texture coordinates of a material: a set of the mesh, and the transform of
// KHR_texture_transform.
struct GltfCoordinates {
  std::uint64_t set = 0;
  Vec2 offset{0, 0}, scale{1, 1};
  float rotation = 0;  // radians
  bool operator==(const GltfCoordinates&) const = default;
};

// What an animation says of one property of a node.
struct GltfTrack {
  enum class Kind : std::uint8_t { linear, step, cubic } kind = Kind::linear;
  std::size_t components = 3;
  std::vector<double> times;  // seconds, ascending
  // Of each key; of a cubic track the tangent before it, the value and the tangent behind it.
  std::vector<float> values;
};

// A glTF file while it is read. Errors name the file and a JSON pointer in it.
struct GltfLoad {
  std::string path;
  Scene& scene;
  std::shared_ptr<const nlohmann::json> document;
  std::vector<unsigned char> chunk;                           // the binary chunk of a GLB
  std::map<std::size_t, std::vector<unsigned char>> buffers;  // buffers read so far
  // For each picture and use: index in Scene::textures, kNone where psf cannot read the picture.
  std::map<std::pair<std::size_t, TextureUse>, int> images;
  std::vector<GltfCoordinates> coordinates;  // for each material of the file
  int first_material = 0;        // index in Scene::materials of the file's first material
  int default_material = kNone;  // for primitives without a material; made when first needed
  CopyCount copies;
  std::set<std::uint64_t> nodes;  // nodes added so far
  // Translation, rotation and scale of nodes that move.
  std::map<std::uint64_t, std::array<std::optional<GltfTrack>, 3>> tracks;

  GltfLoad(std::string file, Scene& target) : path(std::move(file)), scene(target) {}

  [[nodiscard]] JsonCursor root() const { return JsonCursor(*document, path); }
  // The element number `index` of the file's array `array`; messages call the element a `kind`.
  [[nodiscard]] JsonCursor element(const char* array, const JsonCursor& index,
                                   const char* kind) const;

  // Notes that `what` is left out at `where`. Each `what` becomes one warning, whatever the number
  // of places.
  void leave_out(const std::string& what, const std::string& where);
  // Notes the keys that glTF does not have, which are often typing errors; "name", "extras" and
  // "extensions" are known everywhere.
  void check_keys(const JsonCursor& object, std::initializer_list<std::string_view> known);
  // Puts the notes into the scene's warnings.
  void tell();

 private:
  struct Note {
    std::string what, first;
    std::set<std::string> places;
  };
  std::vector<Note> notes_;
};

// The pointer to an object and, where it has one, its name: "/materials/3 (oak)".
[[nodiscard]] std::string gltf_place(const JsonCursor& object);
// The name of an object, or "kind N".
[[nodiscard]] std::string gltf_name(const JsonCursor& object, const char* kind, std::size_t index);
// The first three of some numbers.
[[nodiscard]] inline Rgb to_rgb(std::span<const double> v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
// The extension `name` of an object, if the object has it.
[[nodiscard]] std::optional<JsonCursor> find_extension(const JsonCursor& object, const char* name);

// Reads the JSON and the binary chunk of the file. Throws Error{bad_input} where it is no glTF 2.0.
void read_gltf_file(GltfLoad& load);
// Throws Error{bad_input} that names an extension that the file requires and psf does not have.
// Notes the extensions that are left out.
void check_gltf_extensions(GltfLoad& load);

// The bytes of a buffer view. Throws Error{bad_input} where it reaches outside its buffer.
[[nodiscard]] std::span<const unsigned char> bytes_of(GltfLoad& load,
                                                      const JsonCursor& buffer_view);
[[nodiscard]] bool is_data_uri(const std::string& uri);
// "a data URI of image/png", or the start of the URI in quotes: for messages.
[[nodiscard]] std::string brief_uri(const std::string& uri);
[[nodiscard]] std::vector<unsigned char> decode_data_uri(const JsonCursor& uri);
// The path of the file that a URI names, relative to the glTF file, with percent escapes decoded.
[[nodiscard]] std::string file_of_uri(const GltfLoad& load, const JsonCursor& uri);

// The values of an accessor as floats, (count, components). Normalised integers become [0, 1] or
// [-1, 1]. `components`: the number that the accessor must have.
[[nodiscard]] std::vector<float> read_floats(GltfLoad& load, const JsonCursor& accessor,
                                             std::size_t components);
[[nodiscard]] std::vector<std::uint32_t> read_indices(GltfLoad& load, const JsonCursor& accessor);

// Index in Scene::textures of the texture that a texture info names; kNone, with a note, where psf
// cannot read it. `wanted_by`: material and slot, for messages.
[[nodiscard]] int gltf_texture(GltfLoad& load, const JsonCursor& info, TextureUse use,
                               const std::string& wanted_by);
[[nodiscard]] GltfCoordinates gltf_coordinates(GltfLoad& load, const JsonCursor& info);

// Reads the animations of the file into GltfLoad::tracks.
void read_gltf_animations(GltfLoad& load);
struct GltfNodePose {
  Imath::V3d scale{1, 1, 1};
  std::array<double, 4> rotation{0, 0, 0, 1};  // x, y, z, w
  Imath::V3d translation{0, 0, 0};
};
// Sets what of the node moves to where it is at the scene's frame.
void animate_node(const GltfLoad& load, std::uint64_t node, GltfNodePose& pose);

// Adds all materials of the file, in its order, with their textures.
void add_gltf_materials(GltfLoad& load);
// The index in Scene::materials of a primitive's material, or of glTF's default material.
[[nodiscard]] int gltf_material(GltfLoad& load, const JsonCursor& primitive);

// These add the light, camera or mesh that the number `index` of a node names. `to_scene` and
// `placements` are the transforms from the node to the scene's space, in double; coordinates are
// rounded to float once. A mesh is added once for each of `placements`.
void add_gltf_light(GltfLoad& load, const JsonCursor& index, const Imath::M44d& to_scene);
void add_gltf_camera(GltfLoad& load, const JsonCursor& index, const std::string& name,
                     const Imath::M44d& to_scene);
void add_gltf_mesh(GltfLoad& load, const JsonCursor& index, const std::string& name,
                   std::span<const Imath::M44d> placements);
// The matrix that scales, then rotates (by a quaternion x, y, z, w), then translates row vectors.
[[nodiscard]] Imath::M44d gltf_matrix(const Imath::V3d& scale, std::span<const double, 4> rotation,
                                      const Imath::V3d& translation);
// The transforms, in the node's space, of the instances of a mesh by EXT_mesh_gpu_instancing.
[[nodiscard]] std::vector<Imath::M44d> gltf_instances(GltfLoad& load, const JsonCursor& extension);

}  // namespace psf::render
