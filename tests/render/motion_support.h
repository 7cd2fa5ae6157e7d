// Scenes with things that move, and dumps of them.
#pragma once

#include <fstream>
#include <string>

#include "catch.h"
#include "core/error.h"
#include "moving_scene.h"
#include "render/job/job.h"
#include "render/scene/load.h"
#include "render_dump.h"

namespace psf::render {

// Writes a file and returns its path.
inline std::string written(const tests::TempFolder& folder, const std::string& name,
                           const std::string& text) {
  std::ofstream(folder / name) << text;
  return folder / name;
}

inline Scene moving_scene_of(const std::string& text) {
  const tests::TempFolder folder;
  return load_scene(written(folder, "s.json", text));
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
  const tests::TempFolder folder;
  Job job = quiet_job(written(folder, "s.json", text), folder / "a.pvb", passes);
  job.overrides = overrides;
  static_cast<void>(run_job(job));
  return tests::read_all(job.output);
}

}  // namespace psf::render
