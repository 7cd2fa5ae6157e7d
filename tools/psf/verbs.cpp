// The command line of psf: what it says of itself, and its verbs in the order of the help.
#include "verbs.h"

#include "build_info.h"
#include "cli.h"
#include "filter/engine/instruction_sets.h"

namespace psf::tools {

void declare_psf(CLI::App& app) {
  app.name("psf");
  app.description(
      "Path space filtering, offline: filters, checks and compares what a renderer dumped.");
  app.set_version_flag("--version",
                       [] { return version_text("psf", filter::engine::instruction_set()); });
  app.require_subcommand(1);
  set_example(app, "psf filter scene.pvb -o filtered.exr");
  add_filter(app);
  add_info(app);
  add_verify(app);
  add_recover(app);
  add_cat(app);
  add_export(app);
  add_compare(app);
  add_flicker(app);
  add_relight(app);
  add_sweep(app);
  add_converge(app);
  add_tune(app);
  add_ablate(app);
  add_explain(app);
#ifdef PSF_WITH_REPORT
  add_report(app);
#endif
}

}  // namespace psf::tools
