// psf-bench: measures psf against the targets of its design, as ratios within one run.
#include "bench/benches.h"
#include "cli.h"

int main(int argc, char** argv) {
  CLI::App app;
  psf::bench::declare_psf_bench(app);
  return psf::tools::run_tool(app, argc, argv);
}
