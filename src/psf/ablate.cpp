// Dump::ablate().
#include <utility>

#include "core/apart.h"
#include "core/output_file.h"
#include "metrics/reference.h"
#include "psf/dump_state.h"
#include "psf/library.h"
#include "psf/study.h"
#include "psf/study_parts.h"
#include "psf/version.h"
#include "study/ablate_file.h"
#include "study/ablation_sheet.h"

namespace psf {
namespace {

film::SheetOptions sheet_of(const AblateOptions& options) {
  film::SheetOptions sheet;
  sheet.columns = options.columns;
  sheet.exposure = options.exposure;
  const auto& [x, y, width, height] = options.crop;
  if (options.crop != std::array<std::size_t, 4>{}) sheet.crop = film::Crop{x, y, width, height};
  return sheet;
}

Picture picture_of(const std::vector<Rgb>& colors, const Camera& camera) {
  film::Image image;
  image.width = camera.width;
  image.height = camera.height;
  std::vector<float> values;
  values.reserve(3 * colors.size());
  for (const Rgb& color : colors) values.insert(values.end(), {color.x, color.y, color.z});
  image.add("", "RGB", values);
  return to_picture(std::move(image), camera.name);
}

AblationRow to_row(const study::AblationRow& row, std::span<const metrics::Metric> measured) {
  AblationRow out;
  out.part = study::name(row.part);
  out.label = row.label;
  if (row.parameters) out.parameters = filter::describe(*row.parameters);
  out.first_pass = row.first;
  out.passes = row.last - row.first;
  for (const metrics::Metric metric : measured) {
    out.errors.emplace_back(metrics::name(metric), row.metrics[metric]);
  }
  out.mean = row.mean;
  out.change = row.change;
  out.neighbors = row.neighbors;
  out.seconds = row.seconds;
  return out;
}

}  // namespace

AblationResult Dump::ablate(const Parameters& parameters, const AblateOptions& options) const {
  const std::shared_lock reading(state_->mutex);
  const run::Dump dump = state_->at(options.vertex);
  check_camera(dump, options.camera);
  const metrics::Metric metric = metrics::parse_metric(options.metric);
  AblationResult result;
  study::AblateRequest request;
  request.parameters = fitted(dump, {&parameters, 1}, result.notes).front();
  request.parameters.validate();
  request.passes = to_run(options.passes);
  request.camera = options.camera;
  request.max_memory = options.max_memory;
  request.on_progress = options.on_progress;
  result.inputs = {absolute(dump.reader().path())};

  study::AblateReport report;
  std::vector<Rgb> truth;
  std::optional<metrics::Reference> prepared;
  std::optional<study::AblationSheet::Truth> shown;
  if (options.reference) {
    const Picture& reference = *options.reference;
    check_reference(reference, dump, options.camera);
    metrics::MetricOptions how;
    how.epsilon = options.epsilon;
    how.exposure = options.exposure;
    truth = colors_of(reference);
    prepared.emplace(truth, reference.width, how);
    request.reference = &*prepared;
    report.measured = metrics::kAllMetrics;
    report.metrics = study::describe_metrics(report.measured, how);
    report.reference = study::describe_reference(reference.file, truth);
    shown = {reference.file, truth, metric, how};
    if (!reference.file.empty()) result.inputs.push_back(absolute(reference.file));
  }
  report.rows = study::plan_ablation(dump, request, result.notes);
  report.version = PSF_VERSION;
  report.input = study::describe_input(dump, request.passes, options.camera);
  study::AblationSheet sheet(dump, request, sheet_of(options), shown);
  request.on_row = [&](const study::AblationRow& row, const std::vector<Rgb>& picture) {
    sheet.add(row, picture);
    result.rows.push_back(to_row(row, report.measured));
    result.rows.back().picture = picture_of(picture, state_->cameras[options.camera]);
  };
  study::ablate(dump, request, report.rows);
  result.json = file_text(study::to_json(report));
  result.png = sheet.sheet().png();
  return result;
}

void AblationResult::save(const std::string& path) const {
  core::check_files(inputs, {path});
  core::write_text_file(path, std::string(png.begin(), png.end()));
}

}  // namespace psf
