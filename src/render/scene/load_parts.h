// The parts of load_scene(), for the loaders alone.
#pragma once

#include <ImathBox.h>

#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/interrupt.h"
#include "render/scene/load.h"
#include "render/scene/scene.h"
#include "render/scene/texture.h"

namespace psf::render {

// Throws Error{interrupted} after ^C or SIGTERM, to end loading.
inline void stop_where_interrupted() {
  core::throw_if_interrupted("nothing was rendered, nothing is written");
}

constexpr float kRadians = std::numbers::pi_v<float> / 180;  // of a degree

// The most triangles and spheres of a scene, with the copies of "repeat".
constexpr std::size_t kMaxPrimitives = std::size_t{1} << 27;
// The most copies of one shape.
constexpr std::size_t kMaxCopies = std::size_t{1} << 22;

// Cameras, lights and vertices must not be farther than this from the middle of a scene, in its
// space. Embree leaves out what is farther away than about 1.8e18.
constexpr float kFarthest = 1e18f;
[[nodiscard]] inline bool in_space(const Vec3& p) {
  return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

// Loads each picture once, whatever the number of materials that use it.
class TextureTable {
 public:
  // `lenient`: a picture in a format that cannot be read is left out with a note, since scenes of
  // other programs may have such formats.
  explicit TextureTable(Scene& scene, bool lenient = false) : scene_(scene), lenient_(lenient) {}
  // Loads a picture; returns its index in Scene::textures, or kNone where it is left out. `file` is
  // relative to the folder of `scene_file`. Where that name does not exist, backslashes as
  // separators and other cases of letters are tried, for scenes from other systems. The error or
  // note about a picture that cannot be read starts with the text that `wanted_by` returns, such as
  // "room.json:31: /materials/2/reflectance_map".
  int load(const std::string& scene_file, const std::string& file, TextureUse use,
           const std::function<std::string()>& wanted_by);

 private:
  Scene& scene_;
  bool lenient_;
  std::map<std::pair<std::string, TextureUse>, int> known_;
};

// Finds `file` relative to the folder of `beside`, as TextureTable::load() does. Returns `file`
// unchanged where nothing like it exists.
[[nodiscard]] std::string find_file(const std::string& beside, const std::string& file);

// `space`; or where `box`, given in it, is far from its origin, a space around the middle of the
// box.
[[nodiscard]] Space moved_space(Space space, const Imath::Box3d& box);
// The space in which a scene should be loaded, by its bounds in its current space. It is the
// current space where that one fits.
[[nodiscard]] Space fitting_space(const Scene& scene);
// Throws Error{limit} for a scene that is too large, too small or, for its size, too far from the
// origin.
void check_scale(const std::string& path, const Scene& scene);
// Warns of vertices that are so far from the origin that a dump loses digits of theirs, and of
// shapes that are so far from the middle of the scene that the scene itself loses digits.
void note_lost_digits(const std::string& path, Scene& scene);
// Calls `load` with an empty scene, again with another space until the scene's space fits, and
// returns the scene.
[[nodiscard]] Scene load_fitting(const std::string& path, const std::function<void(Scene&)>& load);

// Each of these adds the content of a file to the scene, in the scene's space.
void load_json(const std::string& path, Scene& scene);
void load_obj(const std::string& path, Scene& scene);
void load_gltf(const std::string& path, Scene& scene);
// Calls load_obj() or load_gltf() by the file's extension; throws Error{bad_input} for any other.
void load_mesh_file(const std::string& path, Scene& scene);

// The camera of a scene that has none.
[[nodiscard]] Camera automatic_camera(const Scene& scene);
// Applies the command line's changes to the cameras, and checks them.
void override_cameras(const SceneOverrides& overrides, Scene& scene);
// Adds a camera that sees everything where the scene has none, then applies the command line's
// changes. Throws Error{usage} naming the option for values that make no sense.
void apply_overrides(const SceneOverrides& overrides, Scene& scene);

// Drops what cannot be rendered (triangles without area, zero normals), with a warning. Throws
// Error{bad_input} that names mesh and vertex, material, light or camera for values that would
// spoil the picture. `path` is the scene file.
void validate(const std::string& path, Scene& scene);

// Cuts triangles that are thousands of times longer than their distance from a camera, because
// floats could not tell objects on such a triangle from the triangle itself. Others stay as they
// are.
void split_large_triangles(Scene& scene);
// Throws Error{limit} that names a sphere that is so large, compared with its distance from a
// camera, that floats cannot represent its surface.
void check_large_spheres(const std::string& path, const Scene& scene);

// A hash over everything that shapes the picture, without names; 32 hexadecimal digits.
[[nodiscard]] std::string hash_of(const Scene& scene);

}  // namespace psf::render
