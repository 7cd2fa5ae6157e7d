// The parts that load_scene is made of; nothing outside the loaders needs them.
#pragma once

#include <ImathBox.h>

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/interrupt.h"
#include "render/load.h"
#include "render/scene.h"
#include "render/texture.h"

namespace psf::render {

// Ends loading where ^C or SIGTERM came. Throws Error{interrupted}.
inline void stop_where_interrupted() {
  core::throw_if_interrupted("nothing was rendered, nothing is written");
}

// Most triangles and spheres of a scene, copies of "repeat" included.
constexpr std::size_t kMaxPrimitives = std::size_t{1} << 27;
// Most copies of one shape.
constexpr std::size_t kMaxCopies = std::size_t{1} << 22;

// Cameras, lights and vertices are no farther from the middle of a scene, in its space: Embree
// leaves out what is farther away than about 1.8e18.
constexpr float kFarthest = 1e18f;
[[nodiscard]] inline bool in_space(const Vec3& p) {
  return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

// Loads each picture once, whatever the number of materials that want it.
class TextureTable {
 public:
  // `lenient`: a picture that there is no reader for is left out with a note; a scene of another
  // program need not know what psf reads.
  explicit TextureTable(Scene& scene, bool lenient = false) : scene_(scene), lenient_(lenient) {}
  // Index in Scene::textures; kNone for a picture that is left out. `file` is relative to the
  // folder of `scene_file`; where that name does not exist, backslashes and another case are tried,
  // as scenes from other systems have them. The error or note of a picture that cannot be had
  // starts with what `wanted_by` returns, "room.json:31: /materials/2/reflectance_map".
  int load(const std::string& scene_file, const std::string& file, TextureUse use,
           const std::function<std::string()>& wanted_by);

 private:
  Scene& scene_;
  bool lenient_;
  std::map<std::pair<std::string, TextureUse>, int> known_;
};

// `file` relative to the folder of `beside`, see TextureTable::load; unchanged where nothing like
// it exists.
[[nodiscard]] std::string find_file(const std::string& beside, const std::string& file);

// `space`, or where `box`, in it, is far from its origin, one around the middle of the box.
[[nodiscard]] Space moved_space(Space space, const Imath::Box3d& box);
// The space that a scene should be loaded in, from the bounds of what was loaded in its own; that
// one where it fits.
[[nodiscard]] Space fitting_space(const Scene& scene);
// Throws Error{limit} for a scene that is too large, too small or, for its size, too far from the
// origin.
void check_scale(const std::string& path, const Scene& scene);
// Warns of vertices that lie so far from the origin that a dump loses their digits, and of shapes
// so far from the middle of the scene that the scene does.
void note_lost_digits(const std::string& path, Scene& scene);
// What `load` loads into an empty scene, again and again until the scene's space fits.
[[nodiscard]] Scene load_fitting(const std::string& path, const std::function<void(Scene&)>& load);

// Each adds to the scene what its kind of file describes, in the scene's space.
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

// Cuts triangles that are thousands of times longer than a camera is away from them, where floats
// could not tell what stands on them from what is in them. Small ones stay as they are.
void split_large_triangles(Scene& scene);
// Throws Error{limit} naming a sphere that is so large beside its distance from a camera that
// floats have no surface of it.
void check_large_spheres(const std::string& path, const Scene& scene);

// Hexadecimal, 32 digits, over everything that shapes the picture; names do not count.
[[nodiscard]] std::string hash_of(const Scene& scene);

}  // namespace psf::render
