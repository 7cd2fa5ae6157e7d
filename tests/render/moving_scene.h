// A JSON scene of a square before a camera, with keys for both.
#pragma once

#include <string>

namespace psf::render {

// A scene of one white square of side 1 at z = -2, before a sky of radiance 3. The picture of the
// camera is 2 wide and high there, 32 pixels. `square` and `camera`: keys of them, each after a comma.
inline std::string moving_scene(const std::string& square, const std::string& camera = "",
                                const std::string& more = "") {
  return R"({"cameras": [{"name": "c", "eye": [0, 0, 0], "target": [0, 0, -1], "size": [32, 32],
      "fov": 53.13010235415598)" +
         camera + R"(}], "environment": {"radiance": 3}, "materials": [{"name": "white"},
      {"name": "lamp", "reflectance": 0, "emission": 5}], "shapes": [{"shape": "quad",
      "material": "white", "origin": [-0.5, -0.5, -2], "u": [1, 0, 0], "v": [0, 1, 0])" +
         square + "}" + more + "]}";
}

}  // namespace psf::render
