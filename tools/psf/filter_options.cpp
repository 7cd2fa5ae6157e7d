// Declares the options of psf filter and turns their text into parameters.
#include "filter_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/standard_streams.h"
#include "filter/parameters_text.h"
#include "pass_range.h"
#include "run/missing_terms.h"

namespace psf::tools {
namespace {

filter::WeightTerms weights_of(const ParameterOptions& options) {
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
  set(terms.gloss, options.gloss, "--gloss");
  terms.visibility = options.visibility.value_or(terms.visibility);
  terms.material = options.material;
  return terms;
}

void add_weights(CLI::App& command, ParameterOptions& options) {
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
  term("--gloss", options.gloss,
       "on glossy surfaces: norm(n_i - n_j, 10 (omega_i - omega_j)) <= T roughness_i^2 (default "
       "0.8)");
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

filter::TermSet asked_terms(const CLI::App& command) {
  filter::TermSet asked = 0;
  for (std::size_t k = 0; k < filter::kTermCount; ++k) {
    const std::string name = std::string("--") + filter::kTermNames[k];
    if (command.get_option(name)->count() > 0) asked |= filter::TermSet{1} << k;
  }
  return asked;
}

void fit_terms(const run::Dump& dump, std::span<filter::Parameters> sets, filter::TermSet asked,
               std::vector<std::string>& notes) {
  const std::string note = run::switch_off_missing(dump, sets, asked);
  for (const filter::Parameters& set : sets) {
    static_cast<void>(dump.select(set, false));  // throws where what was asked for is missing
  }
  if (!note.empty()) notes.push_back(note);
}

filter::Parameters parameters_of(const ParameterOptions& options) {
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
  parameters.estimator = filter::parse_estimator(options.estimator);
  parameters.agree = options.agree;
  parameters.search = options.search == "brute"   ? search::Kind::brute
                      : options.search == "plain" ? search::Kind::plain
                                                  : search::Kind::flann;
  parameters.validate();
  return parameters;
}

filter::Parameters parameters_of(const FilterOptions& options) {
  filter::Parameters parameters = parameters_of(static_cast<const ParameterOptions&>(options));
  parameters.count_refusals = options.refusals;
  return parameters;
}

std::vector<std::uint64_t> snapshots_of(const std::string& text, std::uint64_t passes) {
  std::vector<std::uint64_t> list;
  if (text == "pow2") {
    for (std::uint64_t n = 1; n <= passes; n *= 2) list.push_back(n);
  } else {
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t comma = std::min(text.find(',', begin), text.size());
      list.push_back(parse_pass(text.substr(begin, comma - begin), "--snapshots"));
      begin = comma + 1;
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return list;
}

run::PictureLayers layers_of(const std::string& text) {
  if (text == "all") return {};
  run::PictureLayers layers = {false, false, false, false, false};
  if (text == "none") return layers;
  const std::pair<std::string_view, bool*> names[] = {{"unfiltered-input", &layers.unfiltered},
                                                      {"neighbors", &layers.neighbors},
                                                      {"radius", &layers.radius},
                                                      {"albedo", &layers.albedo},
                                                      {"normal", &layers.normal}};
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    const std::string one = text.substr(begin, comma - begin);
    const auto* const found = std::find_if(std::begin(names), std::end(names),
                                           [&](const auto& name) { return name.first == one; });
    if (found == std::end(names)) {
      throw Error(
          ErrorCode::usage,
          "--layers: no layer \"" + one +
              "\"; write all, none, or some of unfiltered-input, neighbors, radius, albedo, "
              "normal, with commas between");
    }
    *found->second = true;
    begin = comma + 1;
  }
  return layers;
}

void add_parameter_options(CLI::App& command, ParameterOptions& options) {
  command.add_option("--r0", options.r0, "radius: 8px, 0.02 of the distance, 0.5wu (default 8px)")
      ->type_name("R");
  command
      .add_option("--delta", options.delta,
                  "radius shrinks like n^(-delta/2); in [0, 1), 0 keeps it")
      ->capture_default_str();
  command.add_option("--radius-count", options.radius_count, "what n counts")
      ->check(CLI::IsMember({"samples", "blocks"}))
      ->capture_default_str();
  command
      .add_option("--block", options.block,
                  "paths averaged with each other: 2^16, 16passes, all (default 4passes)")
      ->type_name("B");
  add_weights(command, options);
  command.add_flag("--demodulate", options.demodulate,
                   "average c / rho and multiply by rho: textures stay sharp");
  command.add_option("--iterations", options.iterations, "filter so many times")
      ->capture_default_str();
  command.add_option("--sources", options.sources, "use only this share of the contributions")
      ->type_name("1/K");
  command
      .add_option(
          "--estimator", options.estimator,
          "average; disk: photon mapping's; hash: cells of a jittered grid; control: halves "
          "as control variates, unbiased; adaptive: balls whose contributions agree")
      ->check(CLI::IsMember(filter::kEstimatorNames))
      ->capture_default_str();
  command
      .add_option(
          "--agree", options.agree,
          "of --estimator adaptive: a ball grows while what is around it differs by at most "
          "so many standard errors")
      ->capture_default_str();
  command
      .add_option(
          "--search", options.search,
          "engine: flann; the same result from plain FLANN, a search a record, or by brute force")
      ->check(CLI::IsMember({"flann", "plain", "brute"}))
      ->capture_default_str();
}

void add_filter_options(CLI::App& command, FilterOptions& options) {
  command.add_option("IN", options.input, "path-vertex buffer")->required()->type_name("FILE.pvb");
  command
      .add_option("-o,--output", options.outputs,
                  "picture, .exr with layers or .png; may be repeated")
      ->required()
      ->type_name("FILE")
      ->allow_extra_args(false);
  command
      .add_option("--layers", options.layers,
                  "of an .exr beside the picture: all, none, or some of unfiltered-input, "
                  "neighbors, radius, albedo, normal")
      ->type_name("NAME,NAME,...")
      ->capture_default_str();
  const std::size_t before = command.get_options().size();
  add_parameter_options(command, options);
  const std::vector<CLI::Option*> all = command.get_options();
  CLI::Option* tuned = command.add_option("--tuned", options.tuned,
                                          "take the parameters that psf tune --json chose");
  tuned->type_name("FILE");
  for (std::size_t k = before; k < all.size(); ++k) tuned->excludes(all[k]);
  command.add_option("--passes", options.passes, kPassesHelp)->type_name("FIRST:LAST");
  command
      .add_option("--snapshots", options.snapshots,
                  "also write FILE.0001.exr ... after so many passes")
      ->type_name("pow2|N,N,...");
  command.add_flag("--refusals", options.refusals,
                   "count the pairs in the ball and what each weight refuses: slower");
  command
      .add_option("--max-memory", options.max_memory,
                  "what it may take, 500M or 4G: reads no block ahead, or refuses and says what "
                  "block would fit (default no limit)")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  command
      .add_flag("--follow", options.follow,
                "of a dump that is being written: a new picture whenever a pass is committed, "
                "until it is closed")
      ->excludes("--snapshots");
  add_common(command, options.common);
}

}  // namespace psf::tools
