// Declares the options of psf-render; what they mean is in render/job/options.h.
#include "psf-render/options.h"

#include <string>
#include <vector>

#include "build_info.h"
#include "core/error.h"
#include "option_values.h"
#include "render/job/options.h"

namespace psf::tools {
namespace {

void add_outputs(CLI::App& app, render::Job& job) {
  constexpr auto kGroup = "Output";
  app.add_option("SCENE", job.scene, "scene, .json of ours or a mesh")
      ->required()
      ->type_name("FILE.json|.obj|.gltf|.glb");
  app.add_option("-o,--output", job.output, "path-vertex buffer to write")
      ->type_name("OUT.pvb")
      ->group(kGroup);
  app.add_flag("--resume", job.resume,
               "go on with OUT.pvb where it ends, after ^C, a kill, a time limit or to add passes; "
               "begin it where it is not there")
      ->group(kGroup);
  app.add_option("--image", job.images,
                 "unfiltered picture, .exr or .png; may be given again; with several cameras each "
                 "adds its name")
      ->type_name("FILE.exr|.png")
      ->allow_extra_args(false)
      ->group(kGroup);
}

void add_settings(CLI::App& app, render::Job& job) {
  for (const render::Option& option : render::option_table()) {
    const std::string name = "--" + option.name;
    if (option.is_list) {
      CLI::Option* added = app.add_option_function<std::vector<std::string>>(
          name,
          [&job, &option](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) option.set(job, text);
          },
          option.help);
      added->type_name(option.type)->group(option.group);
      if (option.separator != 0) added->delimiter(option.separator);
      if (option.separator == 0) added->allow_extra_args(false);
      continue;
    }
    CLI::Option* added =
        add_parsed(app, name, option.type, option.expected, option.help,
                   [&job, &option](const std::string& text) { return option.set(job, text); });
    added->group(option.group);
    if (!option.standard.empty()) added->default_str(option.standard);
  }
}

}  // namespace

void declare_psf_render(CLI::App& app, RenderOptions& options) {
  app.name("psf-render");
  app.description(
      "Renders a scene and writes one record per light transport path to a path-vertex buffer,\n"
      "which psf filters.\n");
  set_example(app, "psf-render sample_data/cornell.json -o cornell.pvb --image cornell.png");
  // What every program has comes last: the page begins with what this one is for.
  app.set_help_flag();
  add_outputs(app, options.job);
  add_settings(app, options.job);
  app.option_defaults()->group("General");
  add_common(app, options.common);
  app.set_help_flag("-h,--help", "print this and exit");
  app.set_version_flag(
      "--version", [] { return version_text("psf-render"); }, "print it and exit");
  wrap_descriptions(app);
}

void check_outputs(const RenderOptions& options) {
  const render::Job& job = options.job;
  if (job.output.empty() && job.images.empty()) {
    throw Error(ErrorCode::usage, "nothing to write: give -o OUT.pvb, --image FILE or both");
  }
  if (job.resume && job.output.empty()) {
    throw Error(ErrorCode::usage, "--resume needs the file to go on with: give -o OUT.pvb");
  }
}

}  // namespace psf::tools
