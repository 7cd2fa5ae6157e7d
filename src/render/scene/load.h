// Loads scene files: psf's JSON, OBJ with MTL, glTF and GLB.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace psf::render {

// Changes of a scene by the command line. Where eye, target or up is given, only the first camera
// stays, and keeps the values that are not given. A sky replaces the environment. A sun is added to
// the lights where its direction or its irradiance is given; if only one is given, the direction is
// (0.4, 1, 0.3) or the irradiance 3.
struct SceneOverrides {
  std::optional<Imath::V3d> eye, target;  // world units
  std::optional<Vec3> up;
  std::optional<float> fov;            // horizontal, degrees, of every camera
  std::optional<Vec2> size;            // width, height in pixels, of every camera
  std::optional<Rgb> sky;              // constant radiance
  std::optional<std::string> sky_map;  // equirectangular picture
  std::optional<Vec3> sun_direction;   // toward the sun
  std::optional<Rgb> sun;              // irradiance on a facing surface
  float sun_angle = 0.00465f;          // angular radius, radians
  std::optional<Shutter> shutter;      // of every camera
};

// Loads a scene by its file's extension, applies the overrides, validates the scene and computes
// its hash. A scene without camera gets one that sees all of it. Throws Error{io} for a missing
// file, Error{bad_input} naming file
// and place (line, JSON path), Error{usage} naming the option of a senseless override, Error{limit}
// for more than 2^27 triangles and spheres, for a scene that is too large, too small or, for its
// size, too far from the origin, and for a sphere whose radius is 8,192 times a camera's distance.
// Where something moves while a shutter is open, the scene is loaded at several moments: shapes and
// cameras get their motion. `rest`: also the positions at frame 0.
[[nodiscard]] Scene load_scene(const std::string& path, const SceneOverrides& overrides = {},
                               const Moment& moment = {}, bool rest = false);

// The cameras of another frame of a scene that load_scene() gave, with the same arguments.
[[nodiscard]] std::vector<Camera> cameras_at(const std::string& path,
                                             const SceneOverrides& overrides, const Scene& scene,
                                             double frame);

// The precision of the scene in a dump, whose positions are floats in world units.
struct WorldDigits {
  double across = 0, reach = 0;  // longest side of the scene; greatest distance from the origin
  double step = 0;               // distance between neighbouring floats at `reach`
  [[nodiscard]] double steps() const;
};
[[nodiscard]] WorldDigits world_digits(const Scene& scene);

}  // namespace psf::render
