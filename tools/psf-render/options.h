// The command line of psf-render.
#pragma once

#include "cli.h"
#include "render/job/job.h"

namespace psf::tools {

struct RenderOptions {
  render::Job job;
  CommonOptions common;
};

// Declares the program and its options, which write into `options`. Text that is not a valid value
// of an option is a usage error that says what was expected.
void declare_psf_render(CLI::App& app, RenderOptions& options);

// Throws Error{usage} where nothing is to be written, or nothing that could go on.
void check_outputs(const RenderOptions& options);

}  // namespace psf::tools
