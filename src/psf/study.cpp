#include "psf/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>

#include "core/apart.h"
#include "core/error.h"
#include "core/output_file.h"
#include "metrics/reference.h"
#include "psf/dump_state.h"
#include "psf/library.h"
#include "psf/study_parts.h"
#include "psf/version.h"
#include "study/converge_file.h"
#include "study/parameter_lists.h"
#include "study/sweep.h"
#include "study/tune_file.h"

namespace psf {
namespace {

TuneRow to_row(const study::TuneRow& row) {
  return {filter::describe(row.parameters),
          row.error,
          row.standard_error,
          row.bias_sq,
          row.variance,
          row.neighbors,
          row.sigmas_above_least,
          row.may_be_better};
}

// A row of study::to_rows(): what is text is a parameter, or names.
ConvergeRow to_row(const study::Json& json) {
  ConvergeRow row;
  row.id = json["id"].get<std::string>();
  row.n = json["n"].get<std::uint64_t>();
  const auto& table = filter::parameter_table();
  for (const auto& [name, value] : json.items()) {
    const bool is_parameter = std::any_of(
        table.begin(), table.end(), [&key = name](const auto& one) { return key == one.name; });
    if (is_parameter) {
      if (!value.is_null()) row.parameters.emplace_back(name, value.get<std::string>());
    } else if (name != "n" && (value.is_number() || (value.is_null() && name != "picture"))) {
      row.values.emplace_back(
          name, value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
    }
  }
  return row;
}

}  // namespace

std::string tune_radii() {
  return study::kTuneRadii;
}

SweepResult Dump::sweep(const Picture& reference, std::span<const Parameters> sets,
                        std::span<const std::string> metrics, const FilterOptions& options,
                        std::size_t camera) const {
  const std::shared_lock reading(state_->mutex);
  const run::Dump dump = state_->at(options.vertex);
  check_reference(reference, dump, camera);
  std::vector<metrics::Metric> measured;
  for (const std::string& metric : metrics) measured.push_back(metrics::parse_metric(metric));
  if (measured.empty()) measured = {metrics::Metric::rel_mse};
  const metrics::Reference prepared(colors_of(reference), reference.width, {}, measured);

  SweepResult result;
  const std::vector<filter::Parameters> rows = fitted(dump, sets, result.notes);
  result.rows.resize(rows.size());
  study::SweepRequest request;
  request.rows = rows;
  request.passes = to_run(options.passes);
  request.camera = camera;
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  request.on_row = [&](std::size_t number, const study::SweepRow& row, const std::vector<Rgb>&) {
    SweepRow& out = result.rows[number];
    out.parameters = filter::describe(row.parameters);
    for (const metrics::Metric metric : measured) {
      out.errors.emplace_back(metrics::name(metric), row.metrics[metric]);
    }
    out.neighbors = row.neighbors;
    out.seconds = row.seconds;
  };
  study::run_sweep(dump, prepared, request);
  return result;
}

TuneResult Dump::tune(std::span<const Parameters> sets, const TuneOptions& options) const {
  const std::shared_lock reading(state_->mutex);
  const run::Dump dump = state_->at(options.vertex);
  check_camera(dump, options.camera);
  if (sets.empty()) throw Error(ErrorCode::usage, "`sets`: at least one is needed");
  TuneResult result;
  const std::vector<filter::Parameters> rows = fitted(dump, sets, result.notes);
  study::TuneRequest request;
  request.sets = rows;
  request.passes = to_run(options.passes);
  request.camera = options.camera;
  request.epsilon = options.epsilon;
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  const study::TuneResult tuning = study::tune(dump, request);
  for (const study::TuneRow* row : study::by_error(tuning)) result.rows.push_back(to_row(*row));
  for (const auto& [name, text] : filter::describe(tuning.rows[tuning.best].parameters)) {
    // How to find the neighbours is the user's to say.
    if (name != "search") result.best.set(name, text);
  }
  result.sure = study::may_be_better(tuning) == 0;
  result.unfiltered = tuning.unfiltered;
  result.json = file_text(study::to_json(tuning, dump, request, PSF_VERSION));
  result.inputs = {absolute(dump.reader().path())};
  return result;
}

void TuneResult::save(const std::string& path) const {
  core::check_files(inputs, {path});
  core::write_text_file(path, json);
}

ConvergeResult converge(std::span<const std::string> dumps, const Picture& reference,
                        std::span<const Parameters> sets, const ConvergeOptions& options) {
  if (dumps.empty()) throw Error(ErrorCode::usage, "`dumps`: at least one is needed");
  if (sets.empty()) throw Error(ErrorCode::usage, "`sets`: at least one is needed");
  const std::optional<run::VertexRule> vertex = run::vertex_rule_of(options.vertex);
  const run::Dump first(dumps.front(), vertex);
  check_reference(reference, first, options.camera);
  const run::PassSelection passes = to_run({0, options.passes});
  const std::span<const metrics::Metric> measured =
      options.all_metrics ? std::span<const metrics::Metric>(metrics::kAllMetrics)
                          : std::span<const metrics::Metric>(metrics::kPixelMetrics);
  metrics::MetricOptions how;
  how.epsilon = options.epsilon;
  const std::vector<Rgb> picture = colors_of(reference);
  const metrics::Reference prepared(picture, reference.width, how, measured);

  ConvergeResult result;
  study::ConvergeReport report;
  report.version = PSF_VERSION;
  report.measured = measured;
  report.metrics = study::describe_metrics(measured, how);
  report.reference = study::describe_reference(reference.file, picture);
  std::vector<study::RenderFigures> renders;
  for (const std::string& json : options.render_json) renders.push_back({"`render_json`", json});
  if (!renders.empty()) report.time = study::mean_render_time(renders);
  check_camera(first, options.camera);
  study::check_replicates(dumps, run::last_pass(first, passes));
  std::vector<filter::Parameters> rows = to_filter(sets);
  for (const std::string& path : dumps) {
    const run::Dump replicate(path, vertex);
    fit(replicate, sets, rows, result.notes);  // what any of them lacks is off for all
    report.inputs.push_back(study::describe_input(replicate, passes, options.camera));
  }
  study::ConvergeRequest request;
  request.sets = rows;
  request.n = study::powers_up_to(run::last_pass(first, passes));
  request.camera = options.camera;
  request.vertex = vertex;
  request.with_times = options.times;
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  report.series = study::converge(dumps, prepared, picture, request);
  if (report.time && options.times) {
    report.speed_ups = study::speed_ups(report.series, *report.time);
  }
  for (const study::Json& row : study::to_rows(report)) result.rows.push_back(to_row(row));
  result.json = file_text(study::to_json(report));
  result.csv = study::to_csv(report);
  for (const std::string& path : dumps) result.inputs.push_back(absolute(path));
  if (!reference.file.empty()) result.inputs.push_back(absolute(reference.file));
  return result;
}

void ConvergeResult::save(const std::string& folder) const {
  const study::ConvergePaths paths(folder);
  core::check_apart(inputs, std::vector{paths.json, paths.csv});
  study::check_none_there(paths.json);
  core::make_folder(folder);
  core::check_files(inputs, {paths.json, paths.csv});
  core::write_text_file(paths.csv, csv);
  core::write_text_file(paths.json, json);
}

}  // namespace psf
