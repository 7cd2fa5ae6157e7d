// psf converge: how the error falls as samples accumulate, with bias and variance apart.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli.h"
#include "converge_report.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/unfinished.h"
#include "filter_options.h"
#include "notes.h"
#include "parameter_lists.h"
#include "study/analytic.h"
#include "study/converge_file.h"
#include "study_folder.h"
#include "text.h"
#include "verbs.h"
#include "version.h"

namespace psf::tools {
namespace {

struct ConvergeOptions {
  CommonOptions common;
  ParameterLists lists;
  StudyOptions study;
  std::vector<std::string> inputs, render_figures;
  bool all_metrics = false, no_times = false, analytic = false;
};

// Means over the files that psf-render --json wrote.
study::RenderTime read_render_time(const std::vector<std::string>& paths) {
  study::RenderTime mean;
  for (const std::string& path : paths) {
    std::ifstream file(path);
    if (!file) throw Error(ErrorCode::io, path + ": cannot be read");
    const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
    const auto number = [&](const char* key) {
      if (json.is_object() && json.contains(key) && json[key].is_number()) {
        return json[key].get<double>();
      }
      throw Error(
          ErrorCode::bad_input,
          fmt::format("{}: has no number '{}'; give what psf-render --json wrote", path, key));
    };
    const double passes = number("passes"), output = number("output_seconds");
    mean.render += (number("seconds") - output) / passes;
    mean.dump += output / passes;
  }
  const auto count = static_cast<double>(paths.size());
  return {mean.render / count, mean.dump / count};
}

void keep_progress(study::ConvergeRequest& convergence, core::Progress& progress) {
  convergence.on_progress = [&progress](std::uint64_t done, std::uint64_t total) {
    progress.advance(done, total);
  };
}

void write(const std::string& folder, const study::ConvergeReport& report) {
  const std::filesystem::path path(folder);
  core::write_text_file((path / "converge.csv").string(), study::to_csv(report));
  core::write_json_file((path / "converge.json").string(), study::to_json(report), 1);
}

void refuse_to_overwrite(const std::string& folder) {
  const std::string path = (std::filesystem::path(folder) / "converge.json").string();
  if (std::filesystem::exists(path)) {
    throw Error(ErrorCode::usage, path + ": is there already; give another folder");
  }
}

void run_dumps(const ConvergeOptions& options) {
  std::vector<filter::Parameters> sets = all_sets(options.lists);
  const run::Dump dump(options.inputs.front());
  std::vector<std::string> notes;
  const StudyFolder folder(options.study, dump, notes);
  refuse_to_overwrite(folder.path());
  if (folder.passes().first != 0) {
    throw Error(ErrorCode::usage, "--passes: a convergence study begins with the first pass");
  }
  study::ConvergeReport report;
  report.version = kVersion;
  if (!options.render_figures.empty()) report.time = read_render_time(options.render_figures);
  const std::span<const metrics::Metric> measured =
      options.all_metrics ? std::span<const metrics::Metric>(metrics::kAllMetrics)
                          : std::span<const metrics::Metric>(metrics::kPixelMetrics);
  const metrics::Reference reference(folder.reference_picture(), folder.width(),
                                     folder.metric_options(), measured);
  report.measured = measured;
  report.metrics = study::describe_metrics(measured, folder.metric_options());
  report.reference = study::describe_reference(options.study.reference, folder.reference_picture());
  for (const std::string& path : options.inputs) {
    const run::Dump replicate(path);
    fit_terms(replicate, sets, filter::asked_terms(options.lists.given), notes);
    report.inputs.push_back(
        study::describe_input(replicate, {0, folder.passes().last}, folder.camera()));
  }

  study::ConvergeRequest convergence;
  convergence.sets = sets;
  convergence.n = study::powers_up_to(run::last_pass(dump, folder.passes()));
  convergence.camera = folder.camera();
  convergence.with_times = !options.no_times;
  convergence.max_memory = options.study.max_memory;
  std::vector<std::string> inputs = options.inputs, names = {"converge.json", "converge.csv"};
  inputs.insert(inputs.end(), options.render_figures.begin(), options.render_figures.end());
  for (std::size_t series = 0; options.study.pictures && series <= sets.size(); ++series) {
    for (const std::uint64_t n : convergence.n) names.push_back(study::picture_name(series, n));
  }
  folder.make(std::move(inputs), names, options.common.json);
  print_notes(notes, options.common.quiet);
  core::Progress progress("converge", options.common.quiet);
  keep_progress(convergence, progress);
  if (options.study.pictures) {
    report.with_pictures = true;
    report.reference["picture"] = "reference.exr";
    folder.write_reference();
    convergence.on_picture = [&](std::optional<std::size_t> set, std::uint64_t n,
                                 const std::vector<Rgb>& picture) {
      folder.write(study::picture_name(set ? *set + 1 : 0, n), picture,
                   set ? std::optional(sets[*set]) : std::nullopt);
    };
  }
  report.series =
      study::converge(options.inputs, reference, folder.reference_picture(), convergence);
  progress.finish();
  if (report.time && !options.no_times) {
    report.speed_ups = study::speed_ups(report.series, *report.time);
  }
  write(folder.path(), report);
  print_convergence(report);
  fmt::print("wrote {} and converge.csv\n",
             (std::filesystem::path(folder.path()) / "converge.json").string());
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, study::to_json(report), 1);
  }
}

// The built-in scenes: are the slopes those of theory?
constexpr std::size_t kReplicates = 6;
constexpr std::uint64_t kPasses = 64;
constexpr std::uint64_t kFitFrom = 2;  // passes
constexpr double kTolerance = 0.1;     // allowed difference of a slope

std::vector<study::SlopeCheck> check_slopes(const study::Analytic& scene,
                                            const std::vector<study::ConvergeSeries>& series,
                                            double epsilon, const study::Rectangle& inside) {
  std::vector<study::SlopeCheck> checks;
  for (std::size_t k = 1; k < series.size(); ++k) {
    const filter::Radius& radius = series[k].parameters->radius;
    std::vector<double> n, bias_sq, variance, bias_sq_theory, variance_theory;
    for (const study::ConvergePoint& point : series[k].points) {
      if (point.n < kFitFrom) continue;
      n.push_back(static_cast<double>(point.n));
      bias_sq.push_back(point.parts.bias_sq);
      variance.push_back(point.parts.variance);
      bias_sq_theory.push_back(scene.bias_sq(radius, point.n, epsilon, inside));
      variance_theory.push_back(point.theory.variance);
    }
    const auto add = [&](const char* quantity, const std::vector<double>& measured,
                         const std::vector<double>& theory) {
      study::SlopeCheck check{k, quantity, study::fitted_slope(n, measured),
                              study::fitted_slope(n, theory), false};
      check.passed = std::abs(check.measured - check.theory) <= kTolerance;
      checks.push_back(check);
    };
    add("bias_sq", bias_sq, bias_sq_theory);
    add("variance", variance, variance_theory);
  }
  return checks;
}

// Dumps of a scene in a folder of their own, there as long as they are needed, whatever happens.
class Replicates {
 public:
  Replicates(const study::Analytic& scene, const std::filesystem::path& around)
      : folder_((around / fmt::format(".{}.partial", getpid())).string()), own_folder_(folder_) {
    std::filesystem::create_directory(folder_);
    for (std::size_t r = 0; r < kReplicates; ++r) {
      dumps_.push_back(fmt::format("{}/{}.pvb", folder_, r));
      own_dumps_.emplace_back(dumps_.back());
      scene.write_dump(dumps_.back(), r + 1, kPasses);
    }
  }
  [[nodiscard]] const std::vector<std::string>& dumps() const { return dumps_; }

 private:
  std::string folder_;
  std::vector<std::string> dumps_;
  core::Unfinished own_folder_;
  std::deque<core::Unfinished> own_dumps_;
};

bool run_analytic(const ConvergeOptions& options, study::AnalyticScene which,
                  std::vector<filter::Parameters> sets) {
  const study::Analytic scene(which);
  const std::filesystem::path folder = std::filesystem::path(options.study.folder) / scene.name();
  std::filesystem::create_directories(folder);
  refuse_to_overwrite(folder.string());
  double largest = 0;
  for (filter::Parameters& set : sets) {
    set.block = {filter::BlockSize::Kind::passes, 2, 16, 1};
    set.weights = filter::WeightTerms::none();
    set.radius.basis = filter::RadiusBasis::footprint;
    largest = std::max(largest, set.radius.r0);
  }
  const Replicates replicates(scene, folder);
  const std::vector<std::string>& dumps = replicates.dumps();
  const std::vector<Rgb> picture = scene.reference();
  metrics::MetricOptions metric_options;
  const metrics::Reference reference(picture, study::Analytic::kSize, metric_options,
                                     metrics::kPixelMetrics);
  study::ConvergeRequest convergence;
  convergence.sets = sets;
  convergence.n = study::powers_up_to(kPasses);
  convergence.with_times = false;
  convergence.region = study::Analytic::inside(largest);
  core::Progress progress(scene.name(), options.common.quiet);
  keep_progress(convergence, progress);
  study::ConvergeReport report;
  report.version = kVersion;
  report.measured = metrics::kPixelMetrics;
  report.metrics = study::describe_metrics(metrics::kPixelMetrics, metric_options);
  report.reference = study::describe_reference("closed form", picture);
  for (const std::string& path : dumps) {
    report.inputs.push_back(study::describe_input(run::Dump(path), {}, 0));
  }
  report.series = study::converge(dumps, reference, picture, convergence);
  progress.finish();
  report.checks = check_slopes(scene, report.series, metric_options.epsilon, convergence.region);
  write(folder.string(), report);
  fmt::print("{}\n", scene.name());
  print_checks(report);
  return std::all_of(report.checks.begin(), report.checks.end(),
                     [](const study::SlopeCheck& check) { return check.passed; });
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
  bool passed = true;
  for (const auto scene : {study::AnalyticScene::smooth, study::AnalyticScene::edge}) {
    passed = run_analytic(options, scene, sets) && passed;
  }
  if (!passed) {
    throw Error(ErrorCode::comparison,
                "--analytic: a slope is off its theory by more than 0.1; see the table");
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
  add_study_options(*command, options->study, false);
  add_parameter_lists(*command, options->lists);
  command
      ->add_option("--render-json", options->render_figures,
                   "what psf-render --json wrote: counts the render's time into speed-ups")
      ->type_name("FILE[,FILE...]")
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
