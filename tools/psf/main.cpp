// psf: offline path space filtering of path-vertex buffers.
#include "build_info.h"
#include "cli.h"
#include "filter/engine/instruction_sets.h"
#include "verbs.h"

int main(int argc, char** argv) {
  CLI::App app(
      "Path space filtering, offline: filters, checks and compares what a renderer dumped.", "psf");
  app.set_version_flag("--version", [] {
    return psf::tools::version_text("psf", psf::filter::engine::instruction_set());
  });
  app.require_subcommand(1);
  psf::tools::set_example(app, "psf filter scene.pvb -o filtered.exr");
  psf::tools::add_filter(app);
  psf::tools::add_info(app);
  psf::tools::add_verify(app);
  psf::tools::add_recover(app);
  psf::tools::add_cat(app);
  psf::tools::add_export(app);
  psf::tools::add_compare(app);
  psf::tools::add_sweep(app);
  psf::tools::add_converge(app);
  psf::tools::add_tune(app);
  psf::tools::add_explain(app);
#ifdef PSF_WITH_REPORT
  psf::tools::add_report(app);
#endif
  return psf::tools::run_tool(app, argc, argv);
}
