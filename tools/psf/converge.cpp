// psf converge: how the error falls as samples accumulate, with bias and variance apart.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli.h"
#include "converge_report.h"
#include "core/apart.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/text.h"
#include "filter_options.h"
#include "notes.h"
#include "parameter_lists.h"
#include "study/analytic_check.h"
#include "study/converge_file.h"
#include "study/render_time.h"
#include "study_folder.h"
#include "verbs.h"
#include "version.h"
#include "vertex_option.h"

namespace psf::tools {
namespace {

struct ConvergeOptions {
  CommonOptions common;
  ParameterLists lists;
  StudyOptions study;
  std::vector<std::string> inputs, render_figures;
  std::string vertex;
  bool all_metrics = false, no_times = false, analytic = false;
};

void write(const study::ConvergePaths& paths, const study::ConvergeReport& report) {
  core::write_text_file(paths.csv, study::to_csv(report));
  core::write_json_file(paths.json, study::to_json(report), 1);
}

// What the report says of the study before it is made. Switches off the terms of `sets` whose
// channels a dump lacks, and says so in `notes`.
study::ConvergeReport describe(const ConvergeOptions& options, const StudyFolder& folder,
                               const metrics::Reference& reference,
                               std::vector<filter::Parameters>& sets,
                               std::vector<std::string>& notes) {
  study::ConvergeReport report;
  report.version = kVersion;
  if (!options.render_figures.empty()) {
    report.time = study::read_render_time(options.render_figures);
  }
  report.measured = reference.metrics();
  report.metrics = study::describe_metrics(report.measured, folder.metric_options());
  report.reference = study::describe_reference(options.study.reference, folder.reference_picture());
  for (const std::string& path : options.inputs) {
    const run::Dump replicate = open_dump(path, options.vertex);
    fit_terms(replicate, sets, filter::asked_terms(options.lists.given), notes);
    report.inputs.push_back(
        study::describe_input(replicate, {0, folder.passes().last}, folder.camera()));
  }
  return report;
}

void make_folder(const ConvergeOptions& options, const StudyFolder& folder,
                 const study::ConvergeRequest& request) {
  std::vector<std::string> inputs = options.inputs, names = {"converge.json", "converge.csv"};
  inputs.insert(inputs.end(), options.render_figures.begin(), options.render_figures.end());
  for (std::size_t series = 0; options.study.pictures && series <= request.sets.size(); ++series) {
    for (const std::uint64_t n : request.n) names.push_back(study::picture_name(series, n));
  }
  folder.make(std::move(inputs), names, options.common.json);
}

void print_and_write(const ConvergeOptions& options, const std::string& folder,
                     const study::ConvergeReport& report) {
  const study::ConvergePaths paths(folder);
  write(paths, report);
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, study::to_json(report), 1);
  }
  print_convergence(report);
  fmt::print("wrote {} and converge.csv\n", paths.json);
}

void run_dumps(const ConvergeOptions& options) {
  std::vector<filter::Parameters> sets = all_sets(options.lists);
  const run::Dump dump = open_dump(options.inputs.front(), options.vertex);
  std::vector<std::string> notes;
  const StudyFolder folder(options.study, dump, notes);
  study::check_none_there(study::ConvergePaths(folder.path()).json);
  if (folder.passes().first != 0) {
    throw Error(ErrorCode::usage, "--passes: a convergence study begins with the first pass");
  }
  study::check_replicates(options.inputs, run::last_pass(dump, folder.passes()));
  const metrics::Reference reference(
      folder.reference_picture(), folder.width(), folder.metric_options(),
      options.all_metrics ? std::span<const metrics::Metric>(metrics::kAllMetrics)
                          : std::span<const metrics::Metric>(metrics::kPixelMetrics));
  study::ConvergeReport report = describe(options, folder, reference, sets, notes);
  study::ConvergeRequest request;
  request.sets = sets;
  request.n = study::powers_up_to(run::last_pass(dump, folder.passes()));
  request.camera = folder.camera();
  request.vertex = dump.vertex_rule();
  request.with_times = !options.no_times;
  request.max_memory = options.study.max_memory;
  make_folder(options, folder, request);
  print_notes(notes, options.common.quiet);
  core::Progress progress("converge", options.common.quiet);
  request.on_progress = [&progress](std::uint64_t done, std::uint64_t total) {
    progress.advance(done, total);
  };
  if (options.study.pictures) {
    report.with_pictures = true;
    report.reference["picture"] = "reference.exr";
    folder.write_reference();
    request.on_picture = [&](std::optional<std::size_t> set, std::uint64_t n,
                             const std::vector<Rgb>& picture) {
      folder.write(study::picture_name(set ? *set + 1 : 0, n), picture,
                   set ? std::optional(sets[*set]) : std::nullopt);
    };
  }
  report.series = study::converge(options.inputs, reference, folder.reference_picture(), request);
  progress.finish();
  if (report.time && !options.no_times) {
    report.speed_ups = study::speed_ups(report.series, *report.time);
  }
  print_and_write(options, folder.path(), report);
}

constexpr std::array kAnalyticScenes = {study::AnalyticScene::smooth, study::AnalyticScene::edge};

std::string analytic_folder(const ConvergeOptions& options, study::AnalyticScene scene) {
  return (std::filesystem::path(options.study.folder) / study::Analytic(scene).name()).string();
}

// Before any work: what is there stays, and --json is none of the tables.
void check_analytic_files(const ConvergeOptions& options) {
  std::vector<std::string> outputs = {options.common.json};
  for (const study::AnalyticScene scene : kAnalyticScenes) {
    const study::ConvergePaths paths(analytic_folder(options, scene));
    study::check_none_there(paths.json);
    outputs.insert(outputs.end(), {paths.json, paths.csv});
  }
  core::check_apart({}, outputs);
  check_files({}, {options.common.json});
}

study::ConvergeReport run_analytic(const ConvergeOptions& options, study::AnalyticScene scene,
                                   std::span<const filter::Parameters> sets) {
  const std::string name = study::Analytic(scene).name(), folder = analytic_folder(options, scene);
  core::make_folder(folder);
  core::Progress progress(name, options.common.quiet);
  study::ConvergeReport report = study::check_analytic(
      scene, sets, folder,
      [&progress](std::uint64_t done, std::uint64_t total) { progress.advance(done, total); });
  progress.finish();
  report.version = kVersion;
  write(study::ConvergePaths(folder), report);
  fmt::print("{}\n", name);
  print_checks(report);
  return report;
}

void run(const ConvergeOptions& options) {
  keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  if (!options.analytic) {
    if (options.inputs.empty() || options.study.reference.empty()) {
      throw Error(ErrorCode::usage,
                  "converge: give a dump and --reference, or --analytic; see psf converge --help");
    }
    return run_dumps(options);
  }
  ParameterLists lists;
  lists.given = {{"r0", "12px"}, {"delta", "0.2,0.333333,0.5"}};
  for (const char* name : {"r0", "delta"}) {
    if (options.lists.given.contains(name)) lists.given[name] = options.lists.given.at(name);
  }
  const std::vector<filter::Parameters> sets = all_sets(lists);
  check_analytic_files(options);
  bool passed = true;
  study::Json figures;
  for (const study::AnalyticScene scene : kAnalyticScenes) {
    const study::ConvergeReport report = run_analytic(options, scene, sets);
    figures[study::Analytic(scene).name()] = study::to_json(report);
    for (const study::SlopeCheck& check : report.checks) passed = passed && check.passed;
  }
  if (!options.common.json.empty()) core::write_json_file(options.common.json, figures, 1);
  if (!passed) {
    throw Error(ErrorCode::comparison,
                fmt::format("--analytic: a slope is off its theory by more than {}; see the table",
                            study::kSlopeTolerance));
  }
}

}  // namespace

void add_converge(CLI::App& app) {
  auto options = std::make_shared<ConvergeOptions>();
  CLI::App* command =
      app.add_subcommand("converge", "errors after 1, 2, 4, ... passes, bias and variance apart");
  command
      ->add_option("IN", options->inputs,
                   "path-vertex buffers: one, or replicates with other seeds, at least three for "
                   "intervals")
      ->type_name("FILE.pvb");
  add_vertex(*command, options->vertex);
  add_study_options(*command, options->study, false);
  add_parameter_lists(*command, options->lists);
  command
      ->add_option(
          "--render-json", options->render_figures,
          "what psf-render --json wrote, comma-separated: counts the render's time into speed-ups")
      ->type_name("FILE.json")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_flag("--all-metrics", options->all_metrics, "SSIM and FLIP too: slower");
  command->add_flag("--no-times", options->no_times,
                    "do not run each set once more to take its time");
  const std::vector<CLI::Option*> others = command->get_options();
  CLI::Option* analytic = command->add_flag(
      "--analytic", options->analytic,
      "built-in scenes with known answers: are the slopes those of theory? Takes -o, --r0 and "
      "--delta");
  for (CLI::Option* other : others) {
    const std::string name = other->get_name();
    const bool fits = name == "--help" || name == "--output" || name == "--r0" || name == "--delta";
    if (!fits) analytic->excludes(other);
  }
  add_common(*command, options->common);
  set_example(*command,
              "psf converge a.pvb b.pvb c.pvb --reference reference.exr --r0 8px,16px --delta "
              "0.33,0.5 -o converge");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
