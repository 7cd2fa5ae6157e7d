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
#include "filter_frames.h"
#include "filter_options.h"
#include "filter_report.h"
#include "formats/write/appender.h"
#include "notes.h"
#include "picture_writer.h"
#include "run/filter_dump.h"
#include "tuned.h"
#include "verbs.h"

namespace psf::tools {
namespace {

using core::Clock;
using core::seconds_since;

constexpr std::chrono::milliseconds kBetweenLooks{200};
constexpr double kPatience = 5;  // seconds without a writer before it is said

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
  check_layers(dump, options.layers, run);
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

// A run over a frame of several; what was interrupted says what there is by then.
std::vector<std::string> filter_frame(const FrameRun& of, run::FilterRequest& run,
                                      PictureWriter& writer, run::FilterResult& outcome,
                                      bool is_first) {
  try {
    return filter_all(*of.frame.dump, run, writer, outcome);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::interrupted || is_first) throw;
    throw Error(ErrorCode::interrupted,
                fmt::format("interrupted in frame {}: the pictures of the frames before it are "
                            "written",
                            of.number.value_or(0)));
  }
}

// The runs one after the other, the first of which is prepared; their figures go to the report.
void filter_runs(const FilterOptions& options, const FilterOptions& chosen, const FrameRuns& runs,
                 FrameRun of, run::FilterRequest run, FilterReport& report) {
  core::Progress progress("filter", options.common.quiet);
  for (std::size_t k = 0; k < runs.count(); ++k) {
    if (k > 0) {
      of = runs[k];
      run = request_of(options, chosen);
      std::vector<std::string> notes;  // those of the first frame, which are told
      prepare(options, chosen, of, run, notes);
    }
    run.on_progress = [&](std::uint64_t done, std::uint64_t total) {
      progress.advance(k * total + done, runs.count() * total);
    };
    PictureWriter writer(of, run);
    run::FilterResult outcome;
    const std::vector<std::string> written = filter_frame(of, run, writer, outcome, k == 0);
    report.written.insert(report.written.end(), written.begin(), written.end());
    report.seconds_write += writer.seconds();
    add(std::move(outcome), report.outcome);
  }
  progress.finish();
}

FilterReport report_of(const FilterOptions& options, const FrameRuns& runs, const FrameRun& first,
                       const run::FilterRequest& run) {
  FilterReport report;
  report.input = options.input;
  report.uuid = first.frame.dump->reader().uuid();
  report.vertex = first.frame.dump->vertex_rule();
  report.parameters = run.parameters;
  report.cameras = first.frame.dump->metadata().cameras;
  report.has_all_layers = options.layers == "all";
  report.frames = runs.frames();
  report.window = run.window;
  return report;
}

void run(const FilterOptions& options) {
  const auto start = Clock::now();
  keep_freed_memory();
  const core::ThreadLimit threads(options.common.threads);
  FilterOptions chosen = options;
  if (!options.tuned.empty()) read_tuned(options.tuned, chosen, chosen.vertex);
  run::FilterRequest run = request_of(options, chosen);
  if (options.follow) wait_for_first_pass(options.input);
  const FrameRuns runs(options, chosen.vertex);
  const FrameRun first = runs[0];
  run.with_noise = !options.common.json.empty() && runs.count() == 1;
  std::vector<std::string> notes;
  prepare(options, chosen, first, run, notes);
  check_all_files(options, runs, run.snapshots);
  print_notes(notes, options.common.quiet);

  FilterReport report = report_of(options, runs, first, run);
  if (options.follow) {
    run::Dump dump = *first.frame.dump;
    PictureWriter writer(first, run);
    report.written = filter_growing(dump, run, writer, options.common.quiet, report.outcome);
    report.seconds_write = writer.seconds();
  } else {
    filter_runs(options, chosen, runs, first, run, report);
  }
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
