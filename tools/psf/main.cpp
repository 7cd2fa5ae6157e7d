// psf: offline path space filtering of path-vertex buffers.
#include "cli.h"
#include "verbs.h"

int main(int argc, char** argv) {
  CLI::App app;
  psf::tools::declare_psf(app);
  return psf::tools::run_tool(app, argc, argv);
}
