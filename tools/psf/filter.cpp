// psf filter: averages the contributions of a dump over nearby vertices and writes pictures.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/seconds.h"
#include "core/standard_streams.h"
#include "core/text.h"
#include "film/image.h"
#include "film/picture_names.h"
#include "filter_options.h"
#include "filter_report.h"
#include "formats/write/appender.h"
#include "notes.h"
#include "pass_range.h"
#include "run/attributes.h"
#include "run/filter_dump.h"
#include "tuned.h"
#include "verbs.h"
#include "version.h"
#include "vertex_option.h"

namespace psf::tools {
namespace {

using core::Clock;
using core::seconds_since;

constexpr std::chrono::milliseconds kBetweenLooks{200};
constexpr double kPatience = 5;  // seconds without a writer before it is said

std::vector<std::string> camera_names(const run::Dump& dump) {
  std::vector<std::string> names;
  for (const formats::CameraInfo& camera : dump.metadata().cameras) names.push_back(camera.name);
  return names;
}

// Writes the pictures of a run, every camera under every name.
class PictureWriter {
 public:
  PictureWriter(const FilterOptions& options, const run::Dump& dump, const run::FilterRequest& run)
      : names_(options.outputs, camera_names(dump)),
        attributes_(run::attributes_of(kVersion, dump, run.parameters)),
        cameras_(dump.metadata().cameras),
        first_(run.passes.first) {
    std::vector<std::string> files = names_.all(run.snapshots);
    for (const std::string& path : files) film::check_image_path(path);
    files.push_back(options.common.json);
    check_files({options.input, options.tuned}, files);
  }

  // Writes the pictures of the first `passes` passes and returns their names. `snapshot`: number
  // for the names; 0: the final pictures.
  std::vector<std::string> write(std::uint64_t snapshot, std::uint64_t passes,
                                 std::span<const run::CameraPictures> pictures) {
    const auto start = Clock::now();
    std::vector<std::string> written;
    for (std::size_t camera = 0; camera < pictures.size(); ++camera) {
      film::Image image = pictures[camera].image();
      image.attributes.insert(image.attributes.begin(), attributes_.begin(), attributes_.end());
      film::add_picture(image.attributes, cameras_[camera].name, first_, first_ + passes);
      for (std::size_t output = 0; output < names_.count(); ++output) {
        core::throw_if_interrupted("not all pictures were written");
        written.push_back(names_.path(output, camera, snapshot));
        film::write_image(written.back(), image);
      }
    }
    seconds_ += seconds_since(start);
    return written;
  }
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  film::PictureNames names_;
  film::Attributes attributes_;
  std::vector<formats::CameraInfo> cameras_;
  std::size_t first_;
  double seconds_ = 0;
};

// The whole dump; returns the names of the files.
std::vector<std::string> filter_all(const run::Dump& dump, run::FilterRequest& run,
                                    PictureWriter& writer, bool quiet, run::FilterResult& outcome) {
  std::vector<std::string> written;
  const auto append = [&](std::vector<std::string> names) {
    written.insert(written.end(), names.begin(), names.end());
  };
  core::Progress progress("filter", quiet);
  run.on_progress = [&progress](std::uint64_t done, std::uint64_t total) {
    progress.advance(done, total);
  };
  run.on_snapshot = [&](std::uint64_t passes, std::span<const run::CameraPictures> pictures) {
    append(writer.write(passes, passes, pictures));
  };
  outcome = run::filter_dump(dump, run);
  progress.finish();
  append(writer.write(0, outcome.passes, outcome.pictures));
  return written;
}

// Whatever is committed, until the dump is closed.
std::vector<std::string> filter_growing(run::Dump& dump, const run::FilterRequest& run,
                                        PictureWriter& writer, bool quiet,
                                        run::FilterResult& outcome) {
  std::vector<std::string> written;
  auto last_seen = Clock::now();
  bool told = false;
  const auto on_pictures = [&](const run::FilterResult& now) {
    written = writer.write(0, now.passes, now.pictures);
    if (!quiet) {
      core::say(fmt::format("{}: {}", core::counted(now.passes, "pass", "passes"),
                            fmt::join(written, ", ")));
    }
    last_seen = Clock::now();
    told = false;
  };
  const auto wait = [&] {
    core::throw_if_interrupted("the pictures are those of the last pass that was committed");
    std::this_thread::sleep_for(kBetweenLooks);
    if (told || quiet || seconds_since(last_seen) < kPatience) return;
    told = !dump.reader().is_being_written();
    if (told) {
      core::say(fmt::format(
          "note: {}: nobody is writing it and it is not closed; resume its writer, or stop here "
          "with ^C",
          dump.reader().path()));
    }
  };
  outcome = run::follow_dump(dump, run, on_pictures, wait);
  return written;
}

// A dump gets its name with its first pass.
void wait_for_first_pass(const std::string& path) {
  const std::string partial = formats::Appender::partial_path(path);
  while (!std::filesystem::exists(path) && std::filesystem::exists(partial)) {
    core::throw_if_interrupted("no pass was committed yet");
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

void run(const FilterOptions& options) {
  const auto start = Clock::now();
  keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  run::FilterRequest run;
  FilterOptions chosen = options;
  if (!options.tuned.empty()) read_tuned(options.tuned, chosen, chosen.vertex);
  run.parameters = filter::parameters_of(chosen);
  run.parameters.count_refusals = options.refusals;
  run.parameters.validate();
  run.layers = layers_of(options.layers);
  run.max_memory = options.max_memory;
  run.with_noise = !options.common.json.empty();
  if (options.follow) wait_for_first_pass(options.input);
  run::Dump dump = open_dump(options.input, chosen.vertex, options.frame);
  run.passes =
      options.frame ? run::passes_of_frame(dump, *options.frame) : parse_passes(options.passes);
  std::vector<std::string> notes;
  fit_terms(dump, {&run.parameters, 1}, filter::asked_terms(chosen.given), notes);
  check_layers(dump, options.layers, run.layers);
  const std::uint64_t last = run.passes.last.value_or(dump.pass_bounds().size() - 1);
  run.snapshots =
      snapshots_of(options.snapshots, last > run.passes.first ? last - run.passes.first : 0);
  if (!options.follow) run::check(dump, run);
  PictureWriter writer(options, dump, run);
  print_notes(notes, options.common.quiet);

  FilterReport report;
  report.input = options.input;
  report.uuid = dump.reader().uuid();
  report.vertex = dump.vertex_rule();
  report.parameters = run.parameters;
  report.cameras = dump.metadata().cameras;
  report.has_all_layers = options.layers == "all";
  const bool quiet = options.common.quiet;
  report.written = options.follow ? filter_growing(dump, run, writer, quiet, report.outcome)
                                  : filter_all(dump, run, writer, quiet, report.outcome);
  report.seconds_write = writer.seconds();
  report.seconds = seconds_since(start);
  report.peak = run::peak_memory();
  print_report(report);
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, to_json(report));
  }
}

}  // namespace

void add_filter(CLI::App& app) {
  auto options = std::make_shared<FilterOptions>();
  CLI::App* command = app.add_subcommand("filter", "filter a dump and write the picture");
  add_filter_options(*command, *options);
  set_example(*command, "psf filter scene.pvb -o filtered.exr -o filtered.png --r0 16px");
  command->callback([options] { run(*options); });
}

}  // namespace psf::tools
