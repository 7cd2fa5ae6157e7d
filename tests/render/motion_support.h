// Scenes of JSON with things that move, and dumps of them.
#pragma once

#include <string>

#include "catch.h"
#include "load_support.h"
#include "render/job/job.h"
#include "render_dump.h"

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

inline Scene scene_of(const std::string& text, double frame = 0,
                      const SceneOverrides& overrides = {}) {
  const TempFolder folder;
  return load_scene(folder.write("s.json", text), overrides, {frame}, true);
}

inline Job quiet_job(const std::string& scene, const std::string& output, std::uint64_t passes) {
  Job job;
  job.scene = scene;
  job.output = output;
  job.settings.passes = passes;
  job.settings.quiet = true;
  job.settings.channels = {"all"};
  return job;
}

inline tests::Columns dump_of(const std::string& text, std::uint64_t passes,
                              const SceneOverrides& overrides = {}) {
  const TempFolder folder;
  Job job = quiet_job(folder.write("s.json", text), folder.write("a", "") + ".pvb", passes);
  job.overrides = overrides;
  static_cast<void>(run_job(job));
  return tests::read_all(job.output);
}

}  // namespace psf::render
