// psf filter
#include "verbs.h"

namespace psf::tools {

void add_filter(CLI::App& app) { app.add_subcommand("filter"); }

}  // namespace psf::tools
