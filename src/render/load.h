// Scene files: JSON of ours, OBJ with MTL, glTF and GLB.
#pragma once

#include <optional>
#include <string>

#include "render/scene.h"

namespace psf::render {

// What the command line adds to or changes in a scene. A pose (eye, target, up) leaves one camera,
// the first, which keeps what is not given. A sky replaces the environment; a sun is added to the
// lights, from (0.4, 1, 0.3) and of irradiance 3 where only one of the two is given.
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
};

// Loads by extension, applies the overrides, validates, computes the hash. A scene without camera
// gets one that sees all of it. Throws Error{io} for a missing file, Error{bad_input} naming file
// and place (line, JSON path), Error{usage} naming the option of a senseless override, Error{limit}
// for more than 2^27 triangles and spheres, for a scene that is too large, too small or, for its
// size, too far from the origin, and for a sphere whose radius is 8,192 times a camera's distance.
[[nodiscard]] Scene load_scene(const std::string& path, const SceneOverrides& overrides = {});

// What a dump, whose positions are floats in world units, keeps of the scene.
struct WorldDigits {
  double across = 0, reach = 0;  // longest side of the scene; its farthest point from the origin
  double step = 0;               // between floats that far from the origin
  [[nodiscard]] double steps() const;
};
[[nodiscard]] WorldDigits world_digits(const Scene& scene);

}  // namespace psf::render
