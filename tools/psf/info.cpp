// psf info
#include "verbs.h"

namespace psf::tools {

void add_info(CLI::App& app) { app.add_subcommand("info"); }

}  // namespace psf::tools
