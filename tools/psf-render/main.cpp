// psf-render: renders a scene into a path-vertex buffer.
#include <fmt/format.h>

#include <string>

#include "core/output_file.h"
#include "core/parallel.h"
#include "core/standard_streams.h"
#include "psf-render/options.h"
#include "render/job/job.h"
#include "version.h"

namespace psf::tools {
namespace {

std::string format_bytes(double bytes) {
  if (bytes >= 1e9) return fmt::format("{:.2f} GB", bytes / 1e9);
  if (bytes >= 1e6) return fmt::format("{:.1f} MB", bytes / 1e6);
  return fmt::format("{:.1f} kB", bytes / 1e3);
}

void print(const render::Job& job, const render::JobResult& result, bool quiet) {
  const render::RenderResult& r = result.render;
  fmt::print("{}: {} passes, {} paths, {} rays in {:.2f} s, {:.2f} M rays/s\n", result.scene,
             r.passes, r.paths, r.rays, r.seconds, result.rays_per_second() / 1e6);
  if (result.bytes) {
    fmt::print("{}: {}\n", job.output, format_bytes(static_cast<double>(*result.bytes)));
  }
  for (const std::string& image : result.images) fmt::print("{}\n", image);
  if (r.non_finite != 0 && !quiet) {
    core::say(
        fmt::format("note: {} paths are not finite; pictures leave them out, the dump keeps them",
                    r.non_finite));
  }
}

void run(RenderOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  check_outputs(options);
  render::Job& job = options.job;
  job.version = kVersion;
  job.other_outputs = {options.common.json};
  job.settings.quiet = options.common.quiet;
  if (!options.common.quiet) {
    job.on_note = [](const std::string& note) { core::say("note: " + as_options(note)); };
  }
  const render::JobResult result = render::run_job(job);
  print(job, result, options.common.quiet);
  if (!options.common.json.empty()) {
    core::write_text_file(options.common.json, render::figures(job, result) + "\n");
  }
  render::throw_if_stopped(job, result);
}

}  // namespace
}  // namespace psf::tools

int main(int argc, char** argv) {
  CLI::App app;
  psf::tools::RenderOptions options;
  psf::tools::declare_psf_render(app, options);
  app.callback([&options] { psf::tools::run(options); });
  return psf::tools::run_tool(app, argc, argv);
}
