// The command line of psf-bench.
#include "bench/benches.h"

#include "build_info.h"
#include "cli.h"
#include "filter/engine/instruction_sets.h"

namespace psf::bench {

void declare_psf_bench(CLI::App& app) {
  app.name("psf-bench");
  app.description(
      "Measures psf on this machine: ratios side by side in one run, medians with spread.");
  app.set_version_flag("--version", [] {
    return tools::version_text("psf-bench", filter::engine::instruction_set());
  });
  app.require_subcommand(1);
  tools::set_example(app, "psf-bench files");
  add_files(app);
  add_filter(app);
  add_sweep(app);
#ifdef PSF_WITH_RENDER
  add_render(app);
#endif
}

}  // namespace psf::bench
