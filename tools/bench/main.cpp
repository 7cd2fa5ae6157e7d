// psf-bench: measures psf against the targets of its design, as ratios within one run.
#include "bench/benches.h"
#include "build_info.h"
#include "cli.h"
#include "filter/engine/instruction_sets.h"

int main(int argc, char** argv) {
  CLI::App app("Measures psf on this machine: ratios side by side in one run, medians with spread.",
               "psf-bench");
  app.set_version_flag("--version", [] {
    return psf::tools::version_text("psf-bench", psf::filter::engine::instruction_set());
  });
  app.require_subcommand(1);
  psf::tools::set_example(app, "psf-bench files");
  psf::bench::add_files(app);
  psf::bench::add_filter(app);
  psf::bench::add_sweep(app);
  return psf::tools::run_tool(app, argc, argv);
}
