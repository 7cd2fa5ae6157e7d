// Declares the options of psf filter and turns their text into parameters.
#include "filter_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/standard_streams.h"
#include "core/text.h"
#include "film/light_layers.h"
#include "filter/parameters/text.h"
#include "pass_range.h"
#include "run/missing_terms.h"
#include "vertex_option.h"

namespace psf::tools {

void fit_terms(const run::Dump& dump, std::span<filter::Parameters> sets, filter::TermSet asked,
               std::vector<std::string>& notes) {
  const std::string note = run::switch_off_missing(dump, sets, asked);
  for (const filter::Parameters& set : sets) {
    static_cast<void>(dump.select(set, false));  // throws where what was asked for is missing
  }
  if (!note.empty()) notes.push_back(note);
}

std::vector<std::uint64_t> snapshots_of(const std::string& text, std::uint64_t passes) {
  std::vector<std::uint64_t> list;
  if (text == "pow2") {
    for (std::uint64_t n = 1; n <= passes; n *= 2) list.push_back(n);
  } else if (!text.empty()) {
    for (const std::string& one : core::split(text, ',')) {
      list.push_back(parse_pass(one, "--snapshots"));
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return list;
}

run::PictureLayers layers_of(const std::string& text) {
  if (text == "all") return {};
  run::PictureLayers layers = run::PictureLayers::none();
  if (text == "none") return layers;
  // In the order of film::kOtherLayers.
  bool* const others[] = {&layers.unfiltered, &layers.neighbors, &layers.radius,   &layers.albedo,
                          &layers.normal,     &layers.alpha,     &layers.fireflies};
  static_assert(std::size(others) == film::kOtherLayers.size());
  std::vector<std::string>& light = *layers.light;
  for (const std::string& name : core::split(text, ',')) {
    const auto other = std::find(film::kOtherLayers.begin(), film::kOtherLayers.end(), name);
    if (other != film::kOtherLayers.end()) {
      *others[other - film::kOtherLayers.begin()] = true;
    } else if (std::find(light.begin(), light.end(), name) == light.end()) {
      light.push_back(name);
    }
  }
  return layers;
}

void check_layers(const run::Dump& dump, const std::string& text, const run::FilterRequest& run) {
  if (text == "all") return;
  const run::PictureLayers& layers = run.layers;
  if (layers.fireflies && !run.parameters.fireflies.spreads()) {
    throw Error(
        ErrorCode::usage,
        "--layers: fireflies are a layer where they are spread; give --fireflies spread, or "
        "leave the layer out");
  }
  const auto need = [&](const char* layer, const char* channel) {
    if (dump.has(channel)) return;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: has no channel {}, which --layers {} needs; leave it out",
                            dump.reader().path(), channel, layer));
  };
  if (layers.albedo) need("albedo", "reflectance");
  if (layers.normal) need("normal", "normal");
  if (layers.alpha) need("alpha", "alpha");
  std::vector<std::string> names(film::kOtherLayers.begin(), film::kOtherLayers.end());
  for (const std::string& name : run::light_layer_names(dump.reader())) names.push_back(name);
  for (const std::string& name : *layers.light) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw Error(
        ErrorCode::usage,
        fmt::format("--layers: no layer \"{}\"; write all, none, or some of {}, with commas "
                    "between",
                    name, fmt::join(names, ", ")));
  }
}

void add_parameter_options(CLI::App& command, filter::ParameterTexts& options) {
  for (const filter::Parameter& parameter : filter::parameter_table()) {
    const std::string name = parameter.name, option = "--" + name;
    const std::string help =
        fmt::format("{} (default {})", parameter.help, parameter.text(filter::Parameters()));
    CLI::Option* added = nullptr;
    if (parameter.is_switch()) {
      added = command.add_flag_function(
          option,
          [&options, name](std::int64_t on) { options.given[name] = on > 0 ? "on" : "off"; }, help);
    } else {
      added = command.add_option_function<std::string>(
          option, [&options, name](const std::string& text) { options.given[name] = text; }, help);
      added->type_name(parameter.type);
    }
    if (parameter.term) added->group("Weights");
  }
  command.add_flag("--no-weights", options.no_weights, "no terms but those given")
      ->group("Weights");
}

namespace {

void add_frame_options(CLI::App& command, FilterOptions& options) {
  command
      .add_option("--frame", options.frame,
                  "of a sequence: only this frame; without it all, where -o has #### for a number")
      ->excludes("--passes")
      ->excludes("--follow")
      ->type_name("N");
  command
      .add_option("--window", options.window.width,
                  "share vertices over K frames, an odd number, the frame itself in their middle")
      ->excludes("--passes")
      ->excludes("--follow")
      ->capture_default_str()
      ->type_name("K");
  command
      .add_option(
          "--relit", options.window.relit,
          fmt::format("with --window: a ball of another frame counts where the means differ "
                      "by at most T standard errors (default {})",
                      *filter::WindowTerms().relit))
      ->type_name("T|off");
  command
      .add_option("--positions", options.window.positions,
                  "with --window: where other frames are searched, at the places of frame 0, which "
                  "what moves keeps (default where the dump has rest_position), or of now")
      ->type_name("rest|world");
}

}  // namespace

void add_filter_options(CLI::App& command, FilterOptions& options) {
  command
      .add_option("IN", options.input,
                  "path-vertex buffer, or the name of one a frame with #### for the number")
      ->required()
      ->type_name("FILE.pvb");
  command
      .add_option("-o,--output", options.outputs,
                  "picture, .exr with layers or .png, with #### one a frame; may be repeated")
      ->required()
      ->type_name("FILE.exr|.png")
      ->allow_extra_args(false);
  add_vertex(command, options.vertex);
  command
      .add_option("--layers", options.layers,
                  "of an .exr beside the picture: all, none, or some of unfiltered-input, "
                  "neighbors, radius, albedo, normal, alpha (with the background apart), fireflies "
                  "(what they spread), and the "
                  "dump's layers of the light")
      ->type_name("NAME,NAME,...")
      ->capture_default_str();
  const std::size_t before = command.get_options().size();
  add_parameter_options(command, options);
  const std::vector<CLI::Option*> all = command.get_options();
  CLI::Option* tuned = command.add_option("--tuned", options.tuned,
                                          "take the parameters that psf tune --json chose");
  tuned->type_name("FILE.json");
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
  add_frame_options(command, options);
  add_common(command, options.common);
}

}  // namespace psf::tools
