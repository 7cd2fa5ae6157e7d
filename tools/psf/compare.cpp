// psf compare: the error of pictures against a reference.
#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "compare_report.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/text.h"
#include "film/image.h"
#include "film/picture.h"
#include "metric_option.h"
#include "metrics/error_picture.h"
#include "metrics/reference.h"
#include "notes.h"
#include "rectangle.h"
#include "trim.h"
#include "verbs.h"

namespace psf::tools {
namespace {

struct CompareOptions {
  std::string picture, reference;
  std::string layer, reference_layer;  // as film::PictureRequest has them
  std::string metric = "relMSE";
  std::optional<double> max, min;
  std::vector<std::string> regions;  // "X,Y,WxH"; none: the whole picture
  std::string trim;                  // "0.1%" or "0.001"; empty: nothing
  metrics::MetricOptions settings;
  std::vector<std::string> error_pictures;
  double error_max = 0;  // 0: chosen by metrics::error_scale
  std::string colors = metrics::kColorMaps[0];
  CommonOptions common;
};

metrics::Region region_of(const std::string& text, const film::Picture& picture) {
  const Rectangle given = parse_rectangle(text, "--region");
  const metrics::Region region = {given.x, given.y, given.width, given.height};
  if (region.width == 0 || region.height == 0 || region.x + region.width > picture.width ||
      region.y + region.height > picture.height) {
    throw Error(ErrorCode::usage,
                fmt::format("--region {}: is empty or reaches out of {}, which is {}x{}", text,
                            picture.path, picture.width, picture.height));
  }
  return region;
}

// Where there is a bound, in which direction it makes sense.
void check_bounds(const CompareOptions& options, metrics::Metric metric) {
  const bool lower = metrics::lower_is_better(metric);
  if (lower ? options.min.has_value() : options.max.has_value()) {
    throw Error(ErrorCode::usage,
                fmt::format("{} is better when {}, bound it with {}", metrics::name(metric),
                            lower ? "lower" : "higher", lower ? "--max" : "--min"));
  }
}

void check_outputs(const CompareOptions& options) {
  for (const std::string& path : options.error_pictures) film::check_image_path(path);
  std::vector<std::string> outputs = options.error_pictures;
  outputs.push_back(options.common.json);
  check_files({options.picture, options.reference}, outputs);
}

void write_error_pictures(const CompareOptions& options, metrics::Metric metric,
                          const metrics::Errors& errors) {
  if (options.error_pictures.empty()) return;
  const metrics::ErrorScale scale = metrics::error_scale(errors, metric, options.error_max);
  for (const std::string& path : options.error_pictures) {
    metrics::write_error_picture(path, errors, metric, options.settings, scale, options.colors);
    const char* what = metrics::error_name(metric);
    if (std::filesystem::path(path).extension() == ".exr") {
      fmt::print("{}: {} in channel Y\n", path, what);
    } else {
      fmt::print("{}: {} in {} from 0 to {:.4g}, {} above\n", path, what, options.colors, scale.max,
                 core::counted(scale.above, "pixel", "pixels"));
    }
  }
}

// Throws Error{comparison} where a row misses the bound.
void judge(const CompareOptions& options, const CompareReport& report) {
  if (!options.max && !options.min) return;
  for (const CompareRow& row : report.rows) {
    const std::string where = row.region.empty() ? "" : " in " + row.region;
    const auto fail = [&](const std::string& what) {
      throw Error(ErrorCode::comparison, options.picture + ": " + what + where);
    };
    if (row.values.non_finite > 0) {
      fail(fmt::format("no bound holds: {} not finite here or in {}",
                       core::counted(row.values.non_finite, "pixel is", "pixels are"),
                       options.reference));
    }
    const double value = row.values[report.first];
    const std::string text =
        fmt::format("{} {}", metrics::name(report.first), value_text(report.first, value));
    // Written so that a not-a-number fails too.
    if (options.max && !(value <= *options.max)) {
      fail(fmt::format("{} is above {:g}", text, *options.max));
    }
    if (options.min && !(value >= *options.min)) {
      fail(fmt::format("{} is below {:g}", text, *options.min));
    }
  }
}

void run(const CompareOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  CompareReport report;
  report.picture = options.picture;
  report.layer = options.layer;
  report.reference = options.reference;
  report.options = options.settings;
  report.options.validate();
  report.first = metrics::parse_metric(options.metric);
  report.trim = parse_trim(options.trim);
  check_bounds(options, report.first);
  check_outputs(options);

  const film::Picture picture = film::read_picture(options.picture, {options.layer, "", "`layer`"});
  const film::Picture reference = film::read_picture(
      options.reference, {options.reference_layer, options.layer, "`reference-layer`"});
  const std::string note = film::check_comparable(picture, reference);
  std::vector<metrics::Choice> choices;
  for (const std::string& text : options.regions) {
    choices.push_back({region_of(text, picture), report.trim});
    report.rows.push_back({text, {}});
  }
  if (choices.empty()) {
    choices.push_back({std::nullopt, report.trim});
    report.rows.push_back({});
  }
  print_notes(picture.notes, options.common.quiet);
  print_notes(reference.notes, options.common.quiet);
  if (!note.empty()) print_notes({note}, options.common.quiet);
  const metrics::Errors errors =
      metrics::Reference(reference.colors, reference.width, options.settings)
          .errors(picture.colors);
  for (std::size_t k = 0; k < choices.size(); ++k) report.rows[k].values = errors.mean(choices[k]);

  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, to_json(report));
  }
  print_values(report);
  print_left_out(report);
  write_error_pictures(options, report.first, errors);
  judge(options, report);
}

void add_error_pictures(CLI::App& command, CompareOptions& options) {
  command
      .add_option("--error", options.error_pictures,
                  "write the metric of every pixel: .exr as values, .png in false colour, cyan "
                  "where not finite; repeatable")
      ->type_name("FILE.exr|.png")
      ->expected(1)
      ->take_all();
  command
      .add_option("--error-max", options.error_max,
                  "error of the brightest colour; without: what 99% of the pixels do not exceed")
      ->check(CLI::PositiveNumber);
  command.add_option("--colors", options.colors, "colour map of --error")
      ->check(CLI::IsMember(
          std::vector<std::string>(std::begin(metrics::kColorMaps), std::end(metrics::kColorMaps))))
      ->capture_default_str();
}

}  // namespace

void add_compare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      app.add_subcommand("compare", "print the error of a picture against a reference");
  command->add_option("PICTURE", options->picture, "EXR picture")
      ->required()
      ->type_name("FILE.exr");
  command->add_option("REFERENCE", options->reference, "EXR picture taken as the truth")
      ->required()
      ->type_name("FILE.exr");
  command
      ->add_option("--layer", options->layer,
                   "compare this layer of PICTURE, for example unfiltered-input; the colours at "
                   "the root, or the only ones there are, unless given")
      ->type_name("NAME");
  command->add_option("--reference-layer", options->reference_layer, "the same of REFERENCE")
      ->type_name("NAME");
  add_metric(*command, options->metric,
             "printed first, bounded by --max or --min, shown by --error");
  command->add_option("--max", options->max, "exit with 1 where the metric is above this")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--min", options->min,
                      "exit with 1 where the metric, PSNR or SSIM, is below this");
  command
      ->add_option("--region", options->regions,
                   "measure these pixels instead of the whole picture; repeatable, a row each, and "
                   "the bound is for each")
      ->type_name("X,Y,WxH")
      ->expected(1)
      ->take_all();
  command
      ->add_option("--trim", options->trim,
                   "leave out of each metric this share of the pixels, those of the largest error: "
                   "0.1%")
      ->type_name("SHARE");
  command
      ->add_option("--epsilon", options->settings.epsilon,
                   "added below the line in relMSE, SMAPE and MAPE")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--exposure", options->settings.exposure,
                   "stops; SSIM and FLIP see the pictures brighter by this, then tone-mapped")
      ->capture_default_str();
  command
      ->add_option("--ppd", options->settings.pixels_per_degree,
                   "pixels per degree of the viewer that FLIP assumes; 67 is a 4K screen of 0.7 m "
                   "at 0.7 m")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  add_error_pictures(*command, *options);
  add_common(*command, options->common);
  set_example(*command, "psf compare filtered.exr reference.exr --metric FLIP --max 0.1");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
