// psf explain: why a pixel of the filtered picture is what it is.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "cli.h"
#include "core/error.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "explain/ply.h"
#include "explain/report.h"
#include "filter_options.h"
#include "notes.h"
#include "option_values.h"
#include "pass_range.h"
#include "verbs.h"
#include "vertex_option.h"

namespace psf::tools {
namespace {

struct ExplainOptions : filter::ParameterTexts {
  CommonOptions common;
  std::string input, vertex, passes, pixel, camera, ply;
  std::optional<std::uint64_t> path;
  std::size_t top = 5;
  bool all = false;
};

std::size_t camera_of(const ExplainOptions& options, const run::Dump& dump) {
  const auto& cameras = dump.metadata().cameras;
  std::string names;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (cameras[k].name == options.camera) return k;
    names += (names.empty() ? "" : ", ") + cameras[k].name;
  }
  if (options.camera.empty() && (cameras.size() == 1 || options.path)) return 0;
  throw Error(ErrorCode::usage,
              options.camera.empty()
                  ? fmt::format("{}: has several cameras; say which with --camera: {}",
                                options.input, names)
                  : fmt::format("--camera: {} has no camera \"{}\", but {}", options.input,
                                options.camera, names));
}

explain::ExplainRequest request_of(const ExplainOptions& options) {
  if (options.pixel.empty() == !options.path.has_value()) {
    throw Error(ErrorCode::usage, "say what to explain: --pixel X,Y or --path I");
  }
  explain::ExplainRequest request;
  request.parameters = filter::parameters_of(options);
  request.parameters.validate();
  request.passes = parse_passes(options.passes);
  request.path = options.path;
  if (options.path) return request;
  const std::size_t comma = std::min(options.pixel.find(','), options.pixel.size());
  const std::string_view text = options.pixel;
  const auto x = parse_number<std::uint32_t>(text.substr(0, comma)),
             y = parse_number<std::uint32_t>(text.substr(std::min(comma + 1, text.size())));
  if (!x || !y) {
    throw Error(ErrorCode::usage,
                fmt::format("--pixel: '{}' is no pixel: write X,Y, 0,0 at the top left", text));
  }
  request.x = *x;
  request.y = *y;
  return request;
}

void run(const ExplainOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  explain::ExplainRequest request = request_of(options);
  check_files({options.input}, {options.common.json, options.ply});
  const run::Dump dump = open_dump(options.input, options.vertex);
  request.camera = camera_of(options, dump);
  std::vector<std::string> notes;
  fit_terms(dump, {&request.parameters, 1}, filter::asked_terms(options.given), notes);
  explain::check(dump, request);
  print_notes(notes, options.common.quiet);

  core::Progress bar("explain", options.common.quiet);
  request.on_progress = [&bar](std::uint64_t done, std::uint64_t total) {
    bar.advance(done, total);
  };
  const explain::ExplainResult explanation = explain::explain(dump, request);
  bar.finish();
  const explain::Attribution whence = explain::attribute(explanation);
  const explain::Report report{dump, explanation, whence,
                               options.all ? explain::kAllRows : options.top, options.all};
  if (!options.common.json.empty()) {
    core::write_text_file(options.common.json, explain::json(report) + "\n");
  }
  if (!options.ply.empty()) static_cast<void>(explain::write_ply(explanation, whence, options.ply));
  fmt::print("{}{}", explain::overview(report), explain::tables(report));
}

}  // namespace

void add_explain(CLI::App& app) {
  auto shared = std::make_shared<ExplainOptions>();
  ExplainOptions& options = *shared;
  CLI::App* command =
      app.add_subcommand("explain", "say why a pixel of the filtered picture is what it is");
  command->add_option("IN", options.input, "path-vertex buffer")->required()->type_name("FILE.pvb");
  add_vertex(*command, options.vertex);
  command->add_option("--pixel", options.pixel, "the pixel, 0,0 at the top left")
      ->type_name("X,Y")
      ->excludes(command
                     ->add_option("--path", options.path,
                                  "this one path instead, by its number in the dump")
                     ->type_name("I"));
  command->add_option("--camera", options.camera, "of a dump of several: the pixel is this one's")
      ->type_name("NAME")
      ->excludes("--path");
  command->add_option("--passes", options.passes, kPassesHelp)->type_name("FIRST:LAST");
  command->add_option("--top", options.top, "rows of each table")->capture_default_str();
  command->add_flag("--all", options.all, "all rows, and every path's vertex")->excludes("--top");
  command
      ->add_option("--ply", options.ply,
                   "write the vertices that play a part as a point cloud: the pixel's own red, "
                   "averaged ones from grey to white by their share, refused ones by the term")
      ->type_name("FILE.ply");
  add_parameter_options(*command, options);
  add_common(*command, options.common);
  wrap_descriptions(*command);
  set_example(*command, "psf explain scene.pvb --pixel 120,88 --visibility=off --ply pixel.ply");
  command->callback([shared] { run(*shared); });
}

}  // namespace psf::tools
