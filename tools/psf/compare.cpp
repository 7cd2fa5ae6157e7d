// psf compare
#include "verbs.h"

namespace psf::tools {

void add_compare(CLI::App& app) { app.add_subcommand("compare"); }

}  // namespace psf::tools
