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
#include "filter_frames.h"
#include "filter_options.h"
#include "filter_report.h"
#include "formats/write/appender.h"
#include "notes.h"
#include "run/attributes.h"
#include "run/filter_dump.h"
#include "tuned.h"
#include "verbs.h"
#include "version.h"

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
  PictureWriter(const FrameRun& of, const run::FilterRequest& run)
      : names_(of.outputs, camera_names(*of.frame.dump)),
        attributes_(run::attributes_of(kVersion, *of.frame.dump, run.parameters)),
        cameras_(of.frame.dump->metadata().cameras),
        first_(run.passes.first) {
    for (const auto& [name, text] : run::describe(run.window)) {
      attributes_.emplace_back("psf:" + name, text);
    }
  }

  // The files that all pictures of a run go to.
  static std::vector<std::string> files_of(const FrameRun& of,
                                           const std::vector<std::uint64_t>& snapshots) {
    const film::PictureNames names(of.outputs, camera_names(*of.frame.dump));
    return names.all(snapshots);
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

// A whole dump or frame; returns the names of the files.
std::vector<std::string> filter_all(const run::Dump& dump, run::FilterRequest& run,
                                    PictureWriter& writer, run::FilterResult& outcome) {
  std::vector<std::string> written;
  const auto append = [&](std::vector<std::string> names) {
    written.insert(written.end(), names.begin(), names.end());
  };
  run.on_snapshot = [&](std::uint64_t passes, std::span<const run::CameraPictures> pictures) {
    append(writer.write(passes, passes, pictures));
  };
  outcome = run::filter_dump(dump, run);
  append(writer.write(0, outcome.passes, outcome.pictures));
  return written;
}

// Adds the figures of a frame to those of the frames before it; the pictures are those of the last.
void add(run::FilterResult one, run::FilterResult& all) {
  if (all.passes == 0) {
    all = std::move(one);
    return;
  }
  all.statistics += one.statistics;
  all.passes += one.passes;
  all.blocks += one.blocks;
  all.not_finite_in_layers += one.not_finite_in_layers;
  all.not_finite_coverage += one.not_finite_coverage;
  all.overflows += one.overflows;
  all.window += one.window;
  all.seconds_read += one.seconds_read;
  all.seconds_film += one.seconds_film;
  if (one.memory.total() > all.memory.total()) all.memory = one.memory;
  all.pictures = std::move(one.pictures);
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

// What the command line asks for, but for the frame.
run::FilterRequest request_of(const FilterOptions& options, const FilterOptions& chosen) {
  run::FilterRequest run;
  run.parameters = filter::parameters_of(chosen);
  run.parameters.count_refusals = options.refusals;
  run.parameters.validate();
  run.layers = layers_of(options.layers);
  run.max_memory = options.max_memory;
  return run;
}

// Completes the request for a run over a dump or a frame of it, and checks it.
void prepare(const FilterOptions& options, const FilterOptions& chosen, const FrameRun& of,
             run::FilterRequest& run, std::vector<std::string>& notes) {
  const run::Dump& dump = *of.frame.dump;
  run.passes = of.frame.passes;
  run.window = of.window;
  fit_terms(dump, {&run.parameters, 1}, filter::asked_terms(chosen.given), notes);
  check_layers(dump, options.layers, run.layers);
  const std::uint64_t last = run.passes.last.value_or(dump.pass_bounds().size() - 1);
  run.snapshots =
      snapshots_of(options.snapshots, last > run.passes.first ? last - run.passes.first : 0);
  if (!options.follow) run::check(dump, run);
}

// Every file that will be written, before any work.
void check_all_files(const FilterOptions& options, const FrameRuns& runs,
                     const std::vector<std::uint64_t>& snapshots) {
  std::vector<std::string> files;
  for (std::size_t k = 0; k < runs.count(); ++k) {
    for (std::string& file : PictureWriter::files_of(runs[k], snapshots)) {
      film::check_image_path(file);
      files.push_back(std::move(file));
    }
  }
  files.push_back(options.common.json);
  std::vector<std::string> inputs = runs.inputs();
  inputs.push_back(options.tuned);
  check_files(inputs, files);
}

void run(const FilterOptions& options) {
  const auto start = Clock::now();
  keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  FilterOptions chosen = options;
  if (!options.tuned.empty()) read_tuned(options.tuned, chosen, chosen.vertex);
  const run::FilterRequest asked = request_of(options, chosen);
  if (options.follow) wait_for_first_pass(options.input);
  const FrameRuns runs(options, chosen.vertex);
  FrameRun of = runs[0];
  run::FilterRequest run = asked;
  run.with_noise = !options.common.json.empty() && runs.count() == 1;
  std::vector<std::string> notes;
  prepare(options, chosen, of, run, notes);
  check_all_files(options, runs, run.snapshots);
  print_notes(notes, options.common.quiet);

  FilterReport report;
  report.input = options.input;
  report.uuid = of.frame.dump->reader().uuid();
  report.vertex = of.frame.dump->vertex_rule();
  report.parameters = run.parameters;
  report.cameras = of.frame.dump->metadata().cameras;
  report.has_all_layers = options.layers == "all";
  report.frames = runs.frames();
  report.window = run.window;
  const bool quiet = options.common.quiet;
  core::Progress progress("filter", quiet || options.follow);
  for (std::size_t k = 0; k < runs.count(); ++k) {
    if (k > 0) {
      of = runs[k];
      run = asked;
      notes.clear();  // those of the first frame
      prepare(options, chosen, of, run, notes);
    }
    PictureWriter writer(of, run);
    if (options.follow) {
      run::Dump dump = *of.frame.dump;
      report.written = filter_growing(dump, run, writer, quiet, report.outcome);
    } else {
      run::FilterResult outcome;
      run.on_progress = [&](std::uint64_t done, std::uint64_t total) {
        progress.advance(k * total + done, runs.count() * total);
      };
      const std::vector<std::string> written = filter_all(*of.frame.dump, run, writer, outcome);
      report.written.insert(report.written.end(), written.begin(), written.end());
      add(std::move(outcome), report.outcome);
    }
    report.seconds_write += writer.seconds();
  }
  progress.finish();
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
