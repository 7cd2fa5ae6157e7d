// psf filter: averages the contributions of a dump over nearby vertices and writes pictures.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "filter_report.h"
#include "picture_names.h"
#include "verbs.h"
#include "version.h"

namespace psf::tools {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr std::size_t kProgressSteps = 1000;

struct FilterOptions {
  CommonOptions common;
  std::string input;
  std::vector<std::string> outputs;
  // As written; empty: the default.
  std::string r0, block, normal, reflectance, hit_distance, plane, direction, sources, passes,
      snapshots;
  double delta = filter::Radius().delta;
  std::optional<bool> visibility;
  bool material = false, no_weights = false;
  bool demodulate = false, no_refusals = false;
  std::uint32_t iterations = 1;
  std::string search = "plain", estimator = "average", radius_count = "samples";
};

filter::WeightTerms weights_of(const FilterOptions& options) {
  using filter::parse_threshold;
  filter::WeightTerms terms =
      options.no_weights ? filter::WeightTerms::none() : filter::WeightTerms();
  const auto set = [](std::optional<float>& term, const std::string& text, const char* option) {
    if (!text.empty()) term = parse_threshold(text, option);
  };
  set(terms.normal, options.normal, "--normal");
  set(terms.reflectance, options.reflectance, "--reflectance");
  set(terms.hit_distance, options.hit_distance, "--hit-distance");
  set(terms.plane, options.plane, "--plane");
  set(terms.direction, options.direction, "--direction");
  terms.visibility = options.visibility.value_or(terms.visibility);
  terms.material = options.material;
  return terms;
}

filter::Parameters parameters_of(const FilterOptions& options) {
  filter::Parameters parameters;
  if (!options.r0.empty()) filter::parse_radius(options.r0, parameters.radius);
  parameters.radius.delta = options.delta;
  parameters.radius.count =
      options.radius_count == "blocks" ? filter::RadiusCount::blocks : filter::RadiusCount::samples;
  if (!options.block.empty()) parameters.block = filter::parse_block(options.block);
  parameters.weights = weights_of(options);
  parameters.demodulate = options.demodulate;
  parameters.iterations = options.iterations;
  if (!options.sources.empty()) parameters.sources = filter::parse_sources(options.sources);
  parameters.estimator =
      options.estimator == "disk" ? filter::Estimator::disk : filter::Estimator::average;
  parameters.search = options.search == "brute" ? search::Kind::brute : search::Kind::plain;
  parameters.count_refusals = !options.no_refusals;
  parameters.validate();
  return parameters;
}

std::uint64_t pass_number(const std::string& text, const char* option) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw Error(ErrorCode::usage, fmt::format("{}: '{}' is no number of passes", option, text));
  }
  return value;
}

study::PassSelection selection_of(const std::string& text) {
  study::PassSelection selection;
  if (text.empty()) return selection;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw Error(ErrorCode::usage,
                fmt::format("--passes: '{}': write FIRST:LAST, LAST not included", text));
  }
  if (colon > 0) selection.first = pass_number(text.substr(0, colon), "--passes");
  if (colon + 1 < text.size()) selection.last = pass_number(text.substr(colon + 1), "--passes");
  return selection;
}

std::vector<std::uint64_t> snapshots_of(const std::string& text, std::uint64_t passes) {
  std::vector<std::uint64_t> list;
  if (text == "pow2") {
    for (std::uint64_t n = 1; n <= passes; n *= 2) list.push_back(n);
  } else {
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t comma = std::min(text.find(',', begin), text.size());
      list.push_back(pass_number(text.substr(begin, comma - begin), "--snapshots"));
      begin = comma + 1;
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return list;
}

std::vector<std::pair<std::string, std::string>> attributes_of(
    const study::Dump& dump, const filter::Parameters& parameters) {
  const formats::Metadata& metadata = dump.metadata();
  std::vector<std::pair<std::string, std::string>> attributes = {
      {"psf:version", kVersion},
      {"psf:dump", std::filesystem::path(dump.reader().path()).filename().string()},
      {"psf:dump-uuid", dump.reader().uuid()},
      {"psf:scene", metadata.scene},
      {"psf:scene-hash", metadata.scene_hash},
      {"psf:integrator", metadata.integrator},
      {"psf:sampler", metadata.sampler},
      {"psf:seed", std::to_string(metadata.seed)}};
  for (const auto& [name, value] : filter::describe(parameters))
    attributes.emplace_back("psf:" + name, value);
  return attributes;
}

void run(const FilterOptions& options) {
  const auto start = Clock::now();
  const core::ThreadLimit threads(options.common.threads);
  study::FilterRun run;
  run.parameters = parameters_of(options);
  run.passes = selection_of(options.passes);
  const study::Dump dump(options.input);
  const std::uint64_t all_passes = dump.pass_bounds().size() - 1;
  const std::uint64_t last = run.passes.last.value_or(all_passes);
  run.snapshots =
      snapshots_of(options.snapshots, last > run.passes.first ? last - run.passes.first : 0);
  const PictureNames outputs(options.outputs, dump.metadata().cameras);
  outputs.check(run.snapshots);
  if (!options.common.json.empty()) core::OutputFile probe(options.common.json);

  FilterReport report{
      options.input, dump.reader().uuid(), run.parameters, {}, dump.cameras().size(), {}, 0, 0};
  const auto attributes = attributes_of(dump, run.parameters);
  const auto write = [&](std::uint64_t snapshot, std::uint64_t passes,
                         std::span<const study::CameraPictures> pictures) {
    const auto write_start = Clock::now();
    for (std::size_t camera = 0; camera < pictures.size(); ++camera) {
      film::Image image = pictures[camera].image();
      image.attributes = attributes;
      image.attributes.emplace_back("psf:camera", dump.metadata().cameras[camera].name);
      image.attributes.emplace_back(
          "psf:passes", fmt::format("{}:{}", run.passes.first, run.passes.first + passes));
      for (std::size_t output = 0; output < outputs.count(); ++output) {
        core::throw_if_interrupted("not all pictures were written");
        report.written.push_back(outputs.path(output, camera, snapshot));
        film::write_image(report.written.back(), image);
      }
    }
    report.seconds_write += seconds_since(write_start);
  };
  core::Progress progress("filter", kProgressSteps, options.common.quiet);
  run.on_progress = [&progress](std::uint64_t done, std::uint64_t total) {
    progress.advance(static_cast<std::size_t>(1.0 * kProgressSteps * static_cast<double>(done) /
                                              static_cast<double>(total)));
  };
  run.on_snapshot = [&](std::uint64_t passes, std::span<const study::CameraPictures> pictures) {
    write(passes, passes, pictures);
  };
  report.outcome = study::filter_dump(dump, run);
  progress.finish();
  write(0, report.outcome.passes, report.outcome.pictures);
  report.seconds = seconds_since(start);
  print_report(report);
  if (!options.common.json.empty()) {
    core::write_text_file(options.common.json, to_json(report).dump(2) + "\n");
  }
}

void add_weights(CLI::App& command, FilterOptions& options) {
  const auto term = [&command](const char* name, std::string& text, const char* help) {
    command.add_option(name, text, help)->type_name("T|off")->group("Weights");
  };
  term("--normal", options.normal, "n_i . n_j >= T (default 0.95)");
  term("--reflectance", options.reflectance, "norm(rho_i - rho_j) <= T (default 0.05)");
  term("--hit-distance", options.hit_distance,
       "first hits differ by at most T of the longer (default off)");
  term("--plane", options.plane, "at most T radii off the tangent plane (default off)");
  term("--direction", options.direction,
       "directions to the camera: omega_i . omega_j >= T (default off)");
  command
      .add_flag_function(
          "--visibility", [&options](std::int64_t on) { options.visibility = on > 0; },
          "the same lights are visible (default on; --visibility=off)")
      ->group("Weights");
  command.add_flag("--material", options.material, "the same material")->group("Weights");
  command.add_flag("--no-weights", options.no_weights, "no terms but those given")
      ->group("Weights");
}

}  // namespace

void add_filter(CLI::App& app) {
  auto shared = std::make_shared<FilterOptions>();
  FilterOptions& options = *shared;
  CLI::App* command = app.add_subcommand("filter", "filter a dump and write the picture");
  command->add_option("IN", options.input, "path-vertex buffer")->required()->type_name("FILE.pvb");
  command
      ->add_option("-o,--output", options.outputs,
                   "picture, .exr with all layers or .png; may be repeated")
      ->required()
      ->type_name("FILE")
      ->allow_extra_args(false);
  command->add_option("--r0", options.r0, "radius: 8px, 0.02 of the distance, 0.5wu (default 8px)")
      ->type_name("R");
  command
      ->add_option("--delta", options.delta,
                   "radius shrinks like n^(-delta/2); in [0, 1), 0 keeps it")
      ->capture_default_str();
  command->add_option("--radius-count", options.radius_count, "what n counts")
      ->check(CLI::IsMember({"samples", "blocks"}))
      ->capture_default_str();
  command
      ->add_option("--block", options.block,
                   "paths averaged with each other: 2^16, 16passes, all (default 1pass)")
      ->type_name("B");
  add_weights(*command, options);
  command->add_flag("--demodulate", options.demodulate,
                    "average c / rho and multiply by rho: textures stay sharp");
  command->add_option("--iterations", options.iterations, "filter so many times")
      ->capture_default_str();
  command->add_option("--sources", options.sources, "use only this share of the contributions")
      ->type_name("1/K");
  command->add_option("--estimator", options.estimator, "average, or disk: photon mapping's")
      ->check(CLI::IsMember({"average", "disk"}))
      ->capture_default_str();
  command->add_option("--passes", options.passes, "only these passes, from 0, LAST not included")
      ->type_name("FIRST:LAST");
  command
      ->add_option("--snapshots", options.snapshots,
                   "also write FILE.0001.exr ... after so many passes")
      ->type_name("pow2|N,N,...");
  command->add_option("--search", options.search, "neighbour search")
      ->check(CLI::IsMember({"plain", "brute"}))
      ->capture_default_str();
  command->add_flag("--no-refusals", options.no_refusals,
                    "do not count what each weight refuses: faster");
  add_common(*command, options.common);
  set_example(*command, "psf filter scene.pvb -o filtered.exr -o filtered.png --r0 16px");
  command->callback([shared] { run(*shared); });
}

}  // namespace psf::tools
