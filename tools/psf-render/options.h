// The command line of psf-render.
#pragma once

#include <string>
#include <vector>

#include "cli.h"
#include "formats/write/writer.h"
#include "render/loop/render.h"
#include "render/scene/load.h"

namespace psf::tools {

struct RenderOptions {
  std::string scene;
  std::string output;                // the .pvb file; empty: none
  std::vector<std::string> images;   // .exr or .png of the unfiltered picture
  std::vector<std::string> cameras;  // names; empty: the first; "all"
  bool resume = false;
  formats::Codec codec = formats::Codec::zstd;
  render::SceneOverrides overrides;
  render::RenderSettings settings;  // its cameras are set once the scene is loaded
  CommonOptions common;
};

// Declares the options, which write into `options`. Text that is not a valid value of an option is
// a usage error that says what was expected.
void add_render_options(CLI::App& app, RenderOptions& options);

// Checks the command line before anything is loaded: there must be an output, its folder must exist
// and its name must be writable. Throws Error{usage} or Error{io}.
void check_outputs(const RenderOptions& options);

}  // namespace psf::tools
