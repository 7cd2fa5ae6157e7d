// psf sweep: every combination of lists of parameters on one dump, measured against a reference.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cli.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/text.h"
#include "filter_options.h"
#include "notes.h"
#include "parameter_lists.h"
#include "pass_range.h"
#include "study/sweep_file.h"
#include "study_folder.h"
#include "verbs.h"
#include "version.h"
#include "vertex_option.h"

namespace psf::tools {
namespace {

struct SweepOptions {
  CommonOptions common;
  ParameterLists lists;
  StudyOptions study;
  std::string input, vertex;
  bool resume = false;
};

constexpr std::size_t kShown = 10;  // rows of the table

// What a row has that others do not: the parameters of which the sweep has several values.
std::vector<std::string> varied(const study::Json& rows) {
  std::vector<std::string> names;
  for (const auto& parameter : rows[0]["parameters"].items()) {
    const std::string& name = parameter.key();
    const bool differs = std::any_of(rows.begin(), rows.end(), [&](const study::Json& row) {
      return row["parameters"][name] != parameter.value();
    });
    if (differs) names.push_back(name);
  }
  return names;
}

// The best rows by a metric, and what the picture was before.
void print_best(const study::Json& json, metrics::Metric metric) {
  const study::Json& rows = json["rows"];
  if (rows.empty()) return;
  const char* name = metrics::name(metric);
  const auto value_of = [&](const study::Json& row) {
    return row["metrics"][name].is_null() ? std::numeric_limits<double>::quiet_NaN()
                                          : row["metrics"][name].get<double>();
  };
  std::vector<std::size_t> order(rows.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const double x = value_of(rows[a]), y = value_of(rows[b]);
    if (std::isnan(x) || std::isnan(y)) return std::isnan(y) && !std::isnan(x);
    return metrics::lower_is_better(metric) ? x < y : x > y;
  });
  const std::vector<std::string> names = varied(rows);
  const auto width_of = [](const std::string& one) { return std::max<std::size_t>(9, one.size()); };
  fmt::print("{:>4}  {:>10}  {:>10}", "row", name, "neighbours");
  for (const std::string& one : names) fmt::print("  {:>{}}", one, width_of(one));
  fmt::print("\n");
  for (std::size_t k = 0; k < std::min(kShown, order.size()); ++k) {
    const study::Json& row = rows[order[k]];
    fmt::print("{:>4}  {:>10.4g}  {:>10.1f}", row["id"].get<std::string>(), value_of(row),
               row["neighbors"].get<double>());
    for (const std::string& one : names) {
      fmt::print("  {:>{}}", row["parameters"][one].get<std::string>(), width_of(one));
    }
    fmt::print("\n");
  }
  fmt::print("{:>4}  {:>10.4g}  unfiltered\n", "", value_of(json["unfiltered"]));
}

// What runs of the sweep write, beside the tables. Rows are numbered in the order in which they are
// done.
std::vector<std::string> file_names(const SweepOptions& options, const study::SweepFile& file,
                                    std::size_t new_rows) {
  const std::size_t rows = file.json()["rows"].size();
  std::vector<std::string> names = {"sweep.json", "sweep.csv"};
  for (std::size_t k = 0; options.study.pictures && k < new_rows; ++k) {
    names.push_back(study::SweepFile::id(rows + k) + ".exr");
  }
  if (options.study.pictures && !file.has_unfiltered()) names.emplace_back("unfiltered.exr");
  return names;
}

// Filters with the sets that are missing in the file, and adds their rows to it.
void fill(study::SweepFile& file, std::span<const filter::Parameters> missing,
          const run::Dump& dump, const StudyFolder& folder, const SweepOptions& options) {
  const bool pictures = options.study.pictures;
  const metrics::Reference reference(folder.reference_picture(), folder.width(),
                                     folder.metric_options());
  if (pictures) {
    folder.write_reference();
    file.set_reference_picture("reference.exr");
  }
  core::Progress progress("sweep", options.common.quiet);
  study::SweepRequest sweep;
  sweep.rows = missing;
  sweep.passes = folder.passes();
  sweep.camera = folder.camera();
  sweep.max_memory = options.study.max_memory;
  sweep.on_progress = [&](std::uint64_t done, std::uint64_t total) {
    progress.advance(done, total, fmt::format("{} rows", file.json()["rows"].size()));
  };
  sweep.on_unfiltered = [&](const metrics::Metrics& metrics, const std::vector<Rgb>& picture) {
    if (file.has_unfiltered()) return;
    const std::string name = pictures ? "unfiltered.exr" : "";
    if (!name.empty()) folder.write(name, picture, {});
    file.set_unfiltered(metrics, metrics::kAllMetrics, name);
  };
  sweep.on_row = [&](std::size_t, const study::SweepRow& row, const std::vector<Rgb>& picture) {
    const std::string name = pictures ? file.next_id() + ".exr" : "";
    if (!name.empty()) folder.write(name, picture, row.parameters);
    file.add(row, metrics::kAllMetrics, name);
  };
  sweep.on_traversal = [&] { file.write(); };
  if (!missing.empty()) study::run_sweep(dump, reference, sweep);
  progress.finish();
  file.write();
}

void run(const SweepOptions& options) {
  keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  std::vector<filter::Parameters> asked = all_sets(options.lists);
  const run::Dump dump = open_dump(options.input, options.vertex);
  std::vector<std::string> notes;
  fit_terms(dump, asked, filter::asked_terms(options.lists.given), notes);
  const StudyFolder folder(options.study, dump, notes);
  study::SweepFile file(
      folder.path(),
      {kVersion, study::describe_input(dump, folder.passes(), folder.camera()),
       study::describe_reference(options.study.reference, folder.reference_picture()),
       study::describe_metrics(metrics::kAllMetrics, folder.metric_options())},
      options.resume);
  std::vector<filter::Parameters> missing;
  for (const filter::Parameters& set : asked) {
    if (!file.has(set)) missing.push_back(set);
  }
  // What is done of a sweep stays where it is stopped: --resume goes on with it.
  folder.make({options.input}, file_names(options, file, missing.size()), options.common.json)
      .keep();
  print_notes(notes, options.common.quiet);
  fill(file, missing, dump, folder, options);

  print_best(file.json(), folder.metric());
  fmt::print("{} done now, {} were there; wrote {} and sweep.csv\n",
             core::counted(missing.size(), "row", "rows"), asked.size() - missing.size(),
             (std::filesystem::path(folder.path()) / "sweep.json").string());
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, file.json(), 1);
  }
}

}  // namespace

void add_sweep(CLI::App& app) {
  auto options = std::make_shared<SweepOptions>();
  CLI::App* command =
      app.add_subcommand("sweep", "filter with every combination of lists of parameters");
  command->add_option("IN", options->input, "path-vertex buffer")
      ->required()
      ->type_name("FILE.pvb");
  add_vertex(*command, options->vertex);
  add_study_options(*command, options->study, true);
  add_parameter_lists(*command, options->lists);
  command->add_flag("--resume", options->resume, "skip the rows that the folder has already");
  add_common(*command, options->common);
  set_example(*command,
              "psf sweep scene.pvb --reference reference.exr --r0 2px:32px:x2 --delta 0.2,0.33,0.5 "
              "-o sweep");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
