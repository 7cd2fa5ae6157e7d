// psf export: writes a dump in the formats of other programs, and as pictures for denoisers.
#include "export/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "core/apart.h"
#include "core/error.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/text.h"
#include "export/denoisers.h"
#include "formats/read/reader.h"
#include "notes.h"
#include "option_values.h"
#include "pass_range.h"
#include "verbs.h"
#include "version.h"

namespace psf::tools {
namespace {

struct ExportOptions {
  CommonOptions common;
  std::string input, output, format, passes, denoiser, table{formats::kPaths};
  std::vector<std::string> channels;
  std::uint64_t every = 1;
  // As written; empty: not given.
  std::string colour, exposure;
  const CLI::App* command = nullptr;
};

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::usage, why);
}

std::string format_of(const ExportOptions& options) {
  if (!options.format.empty()) return options.format;
  const std::string extension = std::filesystem::path(options.output).extension().string();
  if (extension == ".ply") return "ply";
  if (extension == ".csv") return "csv";
  if (extension.empty()) return "npy";
  refuse(
      fmt::format("{}: unknown format {}; end the name in .ply or .csv, give a folder for .npy "
                  "arrays, or say --format",
                  options.output, extension));
}

exports::PlyOptions ply_options(const ExportOptions& options, const std::string& format) {
  exports::PlyOptions ply;
  if (format != "ply" && !(options.colour.empty() && options.exposure.empty())) {
    refuse(options.output + ": --colour and --exposure are for point clouds (.ply) alone");
  }
  if (!options.colour.empty()) {
    ply.colour = options.colour;
  } else if (options.table != formats::kPaths) {
    ply.colour = "none";  // contribution is a channel of the paths
  }
  if (options.exposure == "auto") {
    ply.exposure.reset();
  } else if (!options.exposure.empty()) {
    ply.exposure = parse_number<float>(options.exposure);
    if (!ply.exposure || std::abs(*ply.exposure) > 100) {
      refuse(fmt::format("--exposure: '{}' is neither auto nor a number of stops from -100 to 100",
                         options.exposure));
    }
  }
  return ply;
}

nlohmann::ordered_json to_json(const ExportOptions& options, const std::string& format,
                               const exports::ExportResult& outcome, double seconds) {
  return {{"file", options.input},
          {"table", options.table},
          {"format", format},
          {"records", outcome.records},
          {"passes", outcome.passes},
          {"written", outcome.written},
          {"without_vertex", outcome.without_vertex},
          {"non_finite", outcome.non_finite},
          {"exposure", outcome.exposure},
          {"files", outcome.files},
          {"bytes", outcome.bytes},
          {"seconds", seconds}};
}

void print(const ExportOptions& options, const std::string& format,
           const exports::ExportResult& outcome) {
  const bool points = format == "ply";
  fmt::print("{}: {} of {}, {:.1f} MB", options.output,
             points ? core::counted(outcome.written, "point", "points")
                    : core::counted(outcome.written, "record", "records"),
             core::counted(outcome.passes, "pass", "passes"),
             static_cast<double>(outcome.bytes) / 1e6);
  if (format == "npy") fmt::print(" in {} files", outcome.files.size());
  if (points) fmt::print("; left out {} without vertex", core::with_commas(outcome.without_vertex));
  if (outcome.non_finite > 0)
    fmt::print(" and {} not finite", core::with_commas(outcome.non_finite));
  if (options.exposure == "auto") fmt::print("; exposure {:.2f}", outcome.exposure);
  fmt::print("\n");
}

// What of the other options has no meaning beside --for.
void check_for_denoiser(const ExportOptions& options) {
  for (const char* name :
       {"--format", "--channels", "--table", "--every", "--colour", "--exposure"}) {
    if (options.command->count(name) == 0) continue;
    refuse(
        fmt::format("{0} has no meaning beside --for {1}, which writes what {1} reads; leave "
                    "out one of them",
                    name, options.denoiser));
  }
}

nlohmann::ordered_json to_json(const ExportOptions& options, const exports::DenoiserResult& outcome,
                               double seconds) {
  return {{"file", options.input},
          {"for", options.denoiser},
          {"paths", outcome.paths.paths},
          {"passes", outcome.paths.passes},
          {"non_finite", outcome.paths.left_out},
          {"overflows", outcome.paths.overflows},
          {"pixels_without_path", outcome.without_path},
          {"pixels_with_one_path", outcome.with_one_path},
          {"files", outcome.files},
          {"bytes", outcome.bytes},
          {"seconds", seconds}};
}

void run_for_denoiser(const ExportOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  check_for_denoiser(options);
  const core::ThreadLimit threads(options.common.threads);
  const auto& names = exports::kDenoiserNames;
  const auto denoiser = static_cast<exports::Denoiser>(
      std::find(names.begin(), names.end(), options.denoiser) - names.begin());
  core::check_apart(std::vector{options.input}, std::vector{options.output, options.common.json});
  check_files({options.input}, {options.common.json});

  const run::Dump dump(options.input);
  core::Progress bar("export", options.common.quiet);
  const exports::DenoiserResult outcome = exports::export_for(
      denoiser, dump, parse_passes(options.passes), options.output, kVersion,
      [&bar](std::uint64_t done, std::uint64_t total) { bar.advance(done, total); });
  bar.finish();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  print_notes(outcome.notes, options.common.quiet);
  fmt::print("{}: for {}: {} of {}, {:.1f} MB in {} files", options.output, options.denoiser,
             core::counted(outcome.paths.paths, "path", "paths"),
             core::counted(outcome.paths.passes, "pass", "passes"),
             static_cast<double>(outcome.bytes) / 1e6, outcome.files.size());
  const std::uint64_t left_out = outcome.paths.left_out + outcome.paths.overflows;
  if (left_out > 0) fmt::print("; left out {} not finite", core::with_commas(left_out));
  fmt::print("\n");
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, to_json(options, outcome, seconds));
  }
}

void run(const ExportOptions& options) {
  if (!options.denoiser.empty()) return run_for_denoiser(options);
  const auto start = std::chrono::steady_clock::now();
  const core::ThreadLimit threads(options.common.threads);
  const std::string format = format_of(options);
  const exports::PlyOptions ply = ply_options(options, format);
  exports::ExportSelection selection;
  selection.table = options.table;
  selection.channels = options.channels;
  selection.passes = parse_passes(options.passes);
  selection.every = options.every;
  core::check_apart(std::vector{options.input}, std::vector{options.output, options.common.json});
  check_files({options.input}, {format == "npy" ? "" : options.output, options.common.json});

  const formats::Reader reader(options.input);
  core::Progress bar("export", options.common.quiet);
  const exports::ExportProgress progress = [&bar](std::uint64_t done, std::uint64_t total) {
    bar.advance(done, total);
  };
  const exports::ExportResult outcome =
      format == "npy"   ? exports::export_npy(reader, selection, options.output, progress)
      : format == "csv" ? exports::export_csv(reader, selection, options.output, progress)
                        : exports::export_ply(reader, selection, ply, options.output, progress);
  bar.finish();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  print(options, format, outcome);
  if (!options.common.json.empty()) {
    core::write_json_file(options.common.json, to_json(options, format, outcome, seconds));
  }
}

}  // namespace

void add_export(CLI::App& app) {
  auto shared = std::make_shared<ExportOptions>();
  ExportOptions& options = *shared;
  CLI::App* command = app.add_subcommand(
      "export", "write a dump as numpy arrays, a point cloud, CSV or pictures for denoisers");
  options.command = command;
  command->add_option("IN", options.input, "path-vertex buffer")->required()->type_name("FILE.pvb");
  command
      ->add_option(
          "-o,--output", options.output,
          "a folder (an .npy for each channel, or with --for the pictures), or a name that "
          "ends in .ply or .csv")
      ->required()
      ->type_name("DIR|FILE.ply|.csv");
  command->add_option("--format", options.format, "the format, whatever the name")
      ->check(CLI::IsMember({"npy", "ply", "csv"}));
  command
      ->add_option("--channels", options.channels,
                   "only these (npy, csv); also these, as scalar fields (ply)")
      ->allow_extra_args(false)
      ->delimiter(',')
      ->type_name("NAME,...");
  command
      ->add_option("--for", options.denoiser,
                   "a folder of pictures that this denoiser takes, made from the same paths: oidn "
                   "(Open Image Denoise: means of colour, albedo and normal), nfor (half buffers "
                   "and variances of colour, albedo, normal and depth), bcd (histograms and "
                   "covariances of colour)")
      ->check(CLI::IsMember(
          std::vector<std::string>(exports::kDenoiserNames.begin(), exports::kDenoiserNames.end())))
      ->type_name("DENOISER");
  command
      ->add_option(
          "--table", options.table,
          "the records to write: paths, or a table of the file, such as vertices or photons")
      ->type_name("NAME")
      ->capture_default_str();
  command->add_option("--passes", options.passes, kPassesHelp)->type_name("FIRST:LAST");
  add_number(*command, "--every", options.every, std::uint64_t{1}, std::uint64_t{1} << 40,
             "only every N-th record; an odd N leaves no stripes");
  command
      ->add_option("--colour,--color", options.colour,
                   "colour of the points: contribution (default of paths), radiance (of the whole "
                   "path), reflectance, normal, any other channel, or none (default of other "
                   "tables). Radiances are multiplied by "
                   "2^exposure, tone-mapped and sRGB-encoded like the .png of psf filter; "
                   "reflectance is sRGB-encoded; normals are (n + 1) / 2; whole numbers get a "
                   "colour each")
      ->type_name("NAME")
      ->group("Point clouds");
  command
      ->add_option("--exposure", options.exposure,
                   "0 by default, as in pictures; auto: the mean of the logarithm of the points' "
                   "luminance is shown as that of 18% grey")
      ->type_name("STOPS|auto")
      ->group("Point clouds");
  add_common(*command, options.common);
  wrap_descriptions(*command);
  set_example(*command, "psf export scene.pvb -o scene.ply --colour radiance --every 7");
  command->callback([shared] { run(*shared); });
}

}  // namespace psf::tools
