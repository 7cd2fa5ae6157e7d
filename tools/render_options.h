// The command line of psf-render.
#pragma once

#include <string>
#include <vector>

#include "cli.h"
#include "formats/writer.h"
#include "render/load.h"
#include "render/render.h"

namespace psf::tools {

struct RenderOptions {
  std::string scene;
  std::string output;                // .pvb; empty: none
  std::vector<std::string> images;   // .exr or .png of the unfiltered picture
  std::vector<std::string> cameras;  // names; empty: the first; "all"
  bool resume = false;
  formats::Codec codec = formats::Codec::zstd;
  render::SceneOverrides overrides;
  render::RenderSettings settings;  // its cameras are set once the scene is loaded
  CommonOptions common;
};

// Declares the options, which write into `options`. Text that is no value of an option is a usage
// error that says what was expected.
void add_render_options(CLI::App& app, RenderOptions& options);

// What the whole of the command line must fulfil before anything is loaded: some output, folders
// that exist, names that can be written. Throws Error{usage} or Error{io}.
void check_outputs(const RenderOptions& options);

}  // namespace psf::tools
