// psf ablate: what each weight, the blocks and iterations do to the picture of one dump.
#include "study/ablate.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ablate_report.h"
#include "cli.h"
#include "core/apart.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/lower.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "filter_options.h"
#include "metric_option.h"
#include "notes.h"
#include "option_values.h"
#include "pass_range.h"
#include "rectangle.h"
#include "study/ablate_file.h"
#include "study/ablation_sheet.h"
#include "study_folder.h"
#include "verbs.h"
#include "version.h"
#include "vertex_option.h"

namespace psf::tools {
namespace fs = std::filesystem;
namespace {

struct AblateOptions : filter::ParameterTexts {
  CommonOptions common;
  std::string input, vertex, passes, camera, reference, reference_layer, crop;
  std::vector<std::string> outputs;
  std::string metric = "relMSE";
  metrics::MetricOptions metrics;
  std::size_t columns = film::SheetOptions().columns;
  std::optional<std::uint64_t> max_memory;  // bytes
};

// What -o asks for, by the ending of the names.
struct AblateOutputs {
  explicit AblateOutputs(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      const std::string ending = core::lower(fs::path(name).extension().string());
      if (ending == ".png") {
        sheets.push_back(name);
      } else if (ending.empty() && folder.empty()) {
        folder = name;
      } else {
        throw Error(ErrorCode::usage, name + (ending.empty() ? ": is a second folder; give one"
                                                             : ": is no name for it; write .png "
                                                               "for a sheet, or a folder's name "
                                                               "without ending"));
      }
    }
  }
  [[nodiscard]] std::string in_folder(const std::string& name) const {
    return (fs::path(folder) / name).string();
  }

  std::vector<std::string> sheets;
  std::string folder;  // empty: none
};

// Checks that nothing is written over, and that all can be, and makes the folder.
void prepare(const AblateOptions& options, const AblateOutputs& outputs, std::size_t rows) {
  std::vector<std::string> outside = outputs.sheets, inside;
  const bool json_is_inside = fs::path(options.common.json).parent_path() == outputs.folder;
  (json_is_inside && !outputs.folder.empty() ? inside : outside).push_back(options.common.json);
  if (!outputs.folder.empty()) {
    study::check_none_there(outputs.in_folder("ablate.json"));
    for (const char* name : {"ablate.json", "ablate.csv"})
      inside.push_back(outputs.in_folder(name));
    if (!options.reference.empty()) inside.push_back(outputs.in_folder("reference.exr"));
    for (std::size_t k = 0; k < rows; ++k) {
      inside.push_back(outputs.in_folder(study::ablation_picture(k)));
    }
  }
  std::vector<std::string> all = outside;
  all.insert(all.end(), inside.begin(), inside.end());
  core::check_apart(std::vector{options.input, options.reference}, all);
  check_files({}, outside);
  if (outputs.folder.empty()) return;
  core::make_folder(outputs.folder);
  check_files({}, inside);
}

film::SheetOptions sheet_of(const AblateOptions& options) {
  film::SheetOptions sheet;
  sheet.columns = options.columns;
  sheet.exposure = options.metrics.exposure;
  if (options.crop.empty()) return sheet;
  const Rectangle crop = parse_rectangle(options.crop, "--crop");
  sheet.crop = film::Crop{crop.x, crop.y, crop.width, crop.height};
  return sheet;
}

// The reference, where there is one, as its file has it and ready to measure with.
struct AblateReference {
  AblateReference(const AblateOptions& options, const run::Dump& dump, std::size_t camera,
                  std::vector<std::string>& notes) {
    if (options.reference.empty()) return;
    picture = read_reference(options.reference, options.reference_layer, dump, camera, notes);
    prepared.emplace(picture.colors, picture.width, options.metrics);
  }

  film::Picture picture;
  std::optional<metrics::Reference> prepared;
};

study::AblateRequest request_of(const AblateOptions& options, const run::Dump& dump,
                                std::vector<std::string>& notes) {
  study::AblateRequest request;
  request.parameters = filter::parameters_of(options);
  request.parameters.validate();
  request.passes = parse_passes(options.passes);
  request.max_memory = options.max_memory;
  request.camera = find_camera(dump, options.camera);
  fit_terms(dump, {&request.parameters, 1}, filter::asked_terms(options.given), notes);
  return request;
}

// With the rows that are to be measured.
study::AblateReport report_of(const AblateOptions& options, const run::Dump& dump,
                              const study::AblateRequest& request, const AblateReference& truth,
                              std::vector<std::string>& notes) {
  study::AblateReport report;
  report.rows = study::plan_ablation(dump, request, notes);
  report.version = kVersion;
  report.input = study::describe_input(dump, request.passes, request.camera);
  if (!truth.prepared) return report;
  report.measured = metrics::kAllMetrics;
  report.metrics = study::describe_metrics(metrics::kAllMetrics, options.metrics);
  report.reference = study::describe_reference(options.reference, truth.picture.colors);
  return report;
}

// Measures the rows; their pictures go to the sheet, and to the folder where there is one.
void measure(const AblateOptions& options, const AblateOutputs& outputs, const run::Dump& dump,
             study::AblateRequest& request, study::AblateReport& report,
             study::AblationSheet& sheet) {
  core::Progress progress("ablate", options.common.quiet);
  request.on_progress = [&](std::uint64_t done, std::uint64_t total) {
    progress.advance(done, total);
  };
  const filter::CameraView& view = dump.cameras()[request.camera];
  std::size_t number = 0;
  request.on_row = [&](const study::AblationRow& row, const std::vector<Rgb>& picture) {
    sheet.add(row, picture);
    const std::string name = study::ablation_picture(number++);
    if (!report.with_pictures) return;
    write_study_picture(outputs.in_folder(name), view.width, view.height, picture, row.parameters,
                        dump.vertex_rule());
  };
  study::ablate(dump, request, report.rows);
  progress.finish();
}

void write_study(study::AblateReport& report, const AblateOutputs& outputs,
                 const AblateReference& truth) {
  if (truth.prepared) {
    const film::Picture& picture = truth.picture;
    write_study_picture(outputs.in_folder("reference.exr"), picture.width, picture.height,
                        picture.colors, std::nullopt, std::nullopt);
    report.reference["picture"] = "reference.exr";
  }
  core::write_text_file(outputs.in_folder("ablate.csv"), study::to_csv(report));
  core::write_json_file(outputs.in_folder("ablate.json"), study::to_json(report), 1);
}

void run(const AblateOptions& options) {
  keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  const AblateOutputs outputs(options.outputs);
  const metrics::Metric metric = metrics::parse_metric(options.metric);
  options.metrics.validate();
  const run::Dump dump = open_dump(options.input, options.vertex);
  std::vector<std::string> notes;
  study::AblateRequest request = request_of(options, dump, notes);
  const AblateReference truth(options, dump, request.camera, notes);
  study::AblateReport report = report_of(options, dump, request, truth, notes);
  report.with_pictures = !outputs.folder.empty();
  std::optional<study::AblationSheet::Truth> shown;
  if (truth.prepared) {
    request.reference = &*truth.prepared;
    shown = {options.reference, truth.picture.colors, metric, options.metrics};
  }
  study::AblationSheet sheet(dump, request, sheet_of(options), shown);
  prepare(options, outputs, report.rows.size());
  print_notes(notes, options.common.quiet);

  measure(options, outputs, dump, request, report, sheet);
  if (report.with_pictures) write_study(report, outputs, truth);
  for (const std::string& path : outputs.sheets) sheet.sheet().write(path);
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, study::to_json(report), 1);
  }
  print_ablation(report, metric);
  for (const std::string& path : options.outputs) fmt::print("wrote {}\n", path);
}

}  // namespace

void add_ablate(CLI::App& app) {
  auto shared = std::make_shared<AblateOptions>();
  AblateOptions& options = *shared;
  CLI::App* command = app.add_subcommand(
      "ablate", "show what each weight, the blocks and iterations do, on one sheet");
  command->add_option("IN", options.input, "path-vertex buffer")->required()->type_name("FILE.pvb");
  add_vertex(*command, options.vertex);
  command
      ->add_option("-o,--output", options.outputs,
                   "sheet of all pictures with labels, .png, or folder for psf report; may be "
                   "repeated")
      ->required()
      ->type_name("DIR|FILE.png")
      ->allow_extra_args(false);
  command->add_option("--reference", options.reference, "what is right: an EXR of the same size")
      ->type_name("FILE.exr");
  command
      ->add_option("--reference-layer,--layer", options.reference_layer,
                   "layer of the reference; the colours at its root, or the only ones there are, "
                   "unless given")
      ->type_name("NAME");
  add_metric(*command, options.metric, "the error on the sheet and in the table");
  command
      ->add_option("--epsilon", options.metrics.epsilon,
                   "of the relative metrics: guards dark places")
      ->capture_default_str();
  command
      ->add_option("--exposure", options.metrics.exposure,
                   "of the sheet, SSIM and FLIP: stops to brighten the pictures")
      ->capture_default_str();
  command->add_option("--crop", options.crop, "show only this part of the pictures, in pixels")
      ->type_name("X,Y,WxH");
  command->add_option("--columns", options.columns, "pictures beside each other")
      ->capture_default_str();
  command->add_option("--passes", options.passes, kPassesHelp)->type_name("FIRST:LAST");
  command->add_option("--camera", options.camera, "which camera, where the dump has several")
      ->type_name("NAME");
  command
      ->add_option("--max-memory", options.max_memory,
                   "what a run of the filter may take, 500M or 4G: leaves blocks out, or refuses "
                   "(default no limit)")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  add_parameter_options(*command, options);
  add_common(*command, options.common);
  wrap_descriptions(*command);
  set_example(*command, "psf ablate scene.pvb --reference reference.exr -o sheet.png -o ablation");
  command->callback([shared] { run(*shared); });
}

}  // namespace psf::tools
