#include "render/scene/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "core/lower.h"
#include "render/scene/load_parts.h"
#include "render/scene/motion.h"

namespace psf::render {
namespace fs = std::filesystem;

namespace {

// `name` in `folder`, or the entry that differs from it in case alone; empty where there is
// neither.
fs::path find_entry(const fs::path& folder, const std::string& name) {
  std::error_code error;
  if (fs::exists(folder / name, error)) return folder / name;
  fs::path found;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string candidate = entry.path().filename().string();
    // The first in alphabetical order: the order of a folder's entries is the file system's.
    if (core::lower(candidate) == core::lower(name) && (found.empty() || entry.path() < found))
      found = entry.path();
  }
  return found;
}

}  // namespace

std::string find_file(const std::string& beside, const std::string& file) {
  std::error_code error;
  const fs::path folder = fs::path(beside).parent_path();
  const fs::path plain = folder / file;
  if (fs::exists(plain, error)) return plain.string();
  std::string slashes = file;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const fs::path parts(slashes);
  fs::path place =
      parts.is_absolute() ? parts.root_path() : (folder.empty() ? fs::path(".") : folder);
  for (const fs::path& part : parts.relative_path()) {
    place = find_entry(place, part.string());
    if (place.empty()) return plain.string();
  }
  return place.string();
}

int TextureTable::load(const std::string& scene_file, const std::string& file, TextureUse use,
                       const std::function<std::string()>& wanted_by) {
  if (scene_.moment.parts != Moment::Parts::all) return kNone;
  const std::string path = find_file(scene_file, file);
  const auto [entry, is_new] = known_.try_emplace({path, use}, kNone);
  if (!is_new) return entry->second;
  scene_.files.push_back(path);
  stop_where_interrupted();
  std::error_code ignored;
  if (lenient_ && fs::exists(path, ignored)) {
    const std::string why = Texture::why_unreadable(path);
    if (!why.empty()) {
      scene_.warnings.push_back(
          fmt::format("{}: {}: {}; the picture is left out", wanted_by(), path, why));
      return kNone;
    }
  }
  try {
    scene_.textures.push_back(Texture::load(path, use, scene_.warnings));
  } catch (const Error& error) {
    throw Error(error.code(), wanted_by() + ": " + error.what());
  }
  entry->second = static_cast<int>(scene_.textures.size()) - 1;
  return entry->second;
}

void load_mesh_file(const std::string& path, Scene& scene) {
  const std::string extension = core::lower(fs::path(path).extension().string());
  if (extension == ".obj") return load_obj(path, scene);
  if (extension == ".gltf" || extension == ".glb") return load_gltf(path, scene);
  throw Error(ErrorCode::bad_input,
              path + ": not a kind of mesh file that psf reads (.obj, .gltf, .glb)");
}

namespace {

// From world units to those of the scene: what is emitted toward a surface of its unit.
void scale_intensities(Scene& scene) {
  for (Light& light : scene.lights) {
    if (light.kind == LightKind::directional || !is_finite(light.intensity)) continue;
    for (int c = 0; c < 3; ++c) {
      light.intensity[c] = std::ldexp(light.intensity[c], -2 * scene.space.exponent);
    }
    if (!is_finite(light.intensity)) {
      throw Error(ErrorCode::limit,
                  fmt::format("{}: light {}: its irradiance at the size of the scene is more than "
                              "a float holds; scale the scene or the light",
                              scene.name, light.name));
    }
  }
}

// Loads a file that is there by its extension.
void load_file(const std::string& path, Scene& empty) {
  const std::string extension = core::lower(fs::path(path).extension().string());
  if (extension == ".json") return load_json(path, empty);
  if (extension == ".obj" || extension == ".gltf" || extension == ".glb") {
    return load_mesh_file(path, empty);
  }
  throw Error(ErrorCode::bad_input,
              path + ": not a kind of scene that psf reads (.json, .obj, .gltf, .glb)");
}

// The scene at another frame, in the same space.
Scene load_again(const std::string& path, const Scene& scene, double frame, Moment::Parts parts) {
  Scene other;
  other.name = scene.name;
  other.space = scene.space;
  other.moment = {frame, scene.moment.fps, parts};
  load_file(path, other);
  stop_where_interrupted();
  return other;
}

}  // namespace

Scene load_scene(const std::string& path, const SceneOverrides& overrides, const Moment& moment,
                 bool rest) {
  std::error_code error;
  if (!fs::exists(path, error)) throw Error(ErrorCode::io, path + ": no such file");
  if (fs::is_directory(path, error))
    throw Error(ErrorCode::io, path + ": is a folder, a scene file is needed");
  Scene scene = load_fitting(path, [&](Scene& empty) {
    empty.moment = moment;
    load_file(path, empty);
  });
  check_scale(path, scene);
  scene.name = fs::path(path).filename().string();
  scale_intensities(scene);
  Motion motion;
  if (!scene.animation.empty()) {
    const auto places_at = [&](double frame) {
      return load_again(path, scene, frame, Moment::Parts::places);
    };
    // So that all frames have the same one.
    if (scene.cameras.empty() && moment.frame != 0) {
      scene.cameras.push_back(automatic_camera(places_at(0)));
    }
    motion = find_motion(overrides, scene, places_at);
    if (rest) keep_rest(scene, moment.frame == 0 ? scene : places_at(0));
  }
  validate(path, scene);  // first: the automatic camera needs finite geometry
  note_lost_digits(path, scene);
  apply_overrides(overrides, scene);
  move_cameras(overrides, motion, scene);
  split_large_triangles(scene);
  check_large_spheres(path, scene);
  scene.hash = hash_of(scene);
  return scene;
}

std::vector<Camera> cameras_at(const std::string& path, const SceneOverrides& overrides,
                               const Scene& scene, double frame) {
  if (scene.animation.empty()) return scene.cameras;
  Scene other = load_again(path, scene, frame, Moment::Parts::cameras);
  if (other.cameras.empty()) return scene.cameras;
  override_cameras(overrides, other);
  return other.cameras;
}

}  // namespace psf::render
