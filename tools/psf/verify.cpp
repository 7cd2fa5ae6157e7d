// psf verify
#include "verbs.h"

namespace psf::tools {

void add_verify(CLI::App& app) { app.add_subcommand("verify"); }

}  // namespace psf::tools
