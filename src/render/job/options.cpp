#include "render/job/options.h"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/number.h"
#include "render/job/option_rows.h"
#include "render/job/option_text.h"

namespace psf::render {
namespace {

using core::parse_number;

constexpr const char* kOutput = "Output";
constexpr const char* kSampling = "Sampling";
constexpr const char* kTransport = "Light transport";
constexpr const char* kScene = "Camera and light, over those of the scene";
constexpr const char* kColour = "three numbers R,G,B of at least 0 or one for grey";
constexpr std::uint32_t kMostLightPaths = 1u << 27;
constexpr std::uint32_t kAllVertices = std::numeric_limits<std::uint16_t>::max();
constexpr float kLongest = std::numeric_limits<float>::max();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

void add_output(std::vector<Option>& table) {
  table.push_back(choice_option(
      "codec", kOutput, [](Job & j) -> auto& { return j.codec; },
      {{"raw", formats::Codec::raw}, {"zstd", formats::Codec::zstd}}, "how columns are stored"));
  Option channels = parsed_option(
      "channels", "NAME,...", kOutput, "names of channels",
      "optional channels to write, comma-separated: default, which is normal, reflectance, "
      "camera, visibility, hit_distance, direction, material, roughness, in scenes with volumes "
      "kind, and what there is unless given; film, lens, time, frame, alpha, kind, rest_position; "
      "or all",
      [](Job& job, const std::string& text) {
        job.settings.channels.push_back(text);
        return true;
      });
  channels.is_list = true;
  channels.separator = ',';
  table.push_back(std::move(channels));
  table.push_back(choice_option(
      "layers", kOutput, [](Job & j) -> auto& { return j.settings.integrator.layers; },
      {{"none", LayerKind::none},
       {"lights", LayerKind::lights},
       {"bounces", LayerKind::bounces},
       {"lobes", LayerKind::lobes}},
      "also write the light by lights, by direct and indirect, or by diffuse and glossy"));
  table.push_back(
      parsed_option("vertices", "all|N", kOutput, "all or a whole number of at least 1",
                    "also write every vertex of every path, or its first N, as the table vertices",
                    [](Job& job, const std::string& text) {
                      const auto most = text == "all" ? std::optional(kAllVertices)
                                                      : parse_number<std::uint32_t>(text);
                      if (!most || *most == 0) return false;
                      job.settings.integrator.vertices = *most;
                      return true;
                    }));
  table.push_back(number_option(
      "photons", kOutput, [](Job & j) -> auto& { return j.settings.integrator.photons; },
      std::uint32_t{0}, kMostLightPaths,
      "also write the vertices of N paths from the lights a pass, as the table photons"));
}

void add_sampling(std::vector<Option>& table) {
  constexpr std::uint64_t kMany = std::numeric_limits<std::uint32_t>::max();
  table.push_back(number_option(
      "passes", kSampling, [](Job & j) -> auto& { return j.settings.passes; }, std::uint64_t{1},
      kMany, "paths a pixel"));
  table.push_back(parsed_option(
      "frames", "FIRST:LAST", kSampling,
      fmt::format("FIRST:LAST, LAST not included, or one frame, from 0 to {}", kMostFrames - 1),
      "frames of the scene, LAST not included, each with all the passes; #### in the name of the "
      "output makes a file a frame; frame 0 unless given",
      [](Job& job, const std::string& text) { return parse_frames(text, job.settings.frames); }));
  table.push_back(choice_option(
      "sampler", kSampling, [](Job & j) -> auto& { return j.settings.sampler.kind; },
      {{"sobol", SamplerKind::sobol},
       {"halton", SamplerKind::halton},
       {"independent", SamplerKind::independent}},
      "where the numbers come from; sobol and halton are Owen-scrambled"));
  table.push_back(choice_option(
      "enumeration", kSampling, [](Job & j) -> auto& { return j.settings.sampler.enumeration; },
      {{"pixel", Enumeration::pixel}, {"global", Enumeration::global}},
      "pixel: each has its own sequence, a pass visits them in order; global: one sequence "
      "over the picture, so that blocks of 2^m paths are nets"));
  table.push_back(number_option(
      "seed", kSampling, [](Job & j) -> auto& { return j.settings.sampler.seed; }, std::uint64_t{0},
      std::numeric_limits<std::uint64_t>::max(), "of the randomisation"));
  table.push_back(number_option(
      "split", kSampling, [](Job & j) -> auto& { return j.settings.integrator.split; },
      std::uint32_t{1}, std::uint32_t{65536},
      "continue every path so many times from its vertex, store the mean"));
  table.push_back(parsed_option(
      "shade-rate", "1/K", kSampling, fmt::format("1 or 1/K, K up to {}", kMostShadeRate),
      "shade one path in K; the others have a vertex and its shadow rays alone",
      [](Job& job, const std::string& text) {
        return parse_shade_rate(text, job.settings.shade_rate);
      },
      "1"));
  table.push_back(number_option(
      "time-limit", kSampling, [](Job & j) -> auto& { return j.settings.time_limit; }, 1e-3,
      std::numeric_limits<double>::infinity(), "seconds; ends after the pass that reaches it",
      "S"));
}

void add_transport(std::vector<Option>& table) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const std::string& name : integrator_names()) names.emplace_back(name, name);
  const auto add = [&table](const char* name, auto member, auto least, auto most, const char* help,
                            const char* type = "N") {
    table.push_back(number_option(
        name, kTransport, [member](Job & j) -> auto& { return j.settings.integrator.*member; },
        least, most, help, type));
  };
  using Settings = IntegratorSettings;
  table.push_back(choice_option(
      "integrator", kTransport, [](Job & j) -> auto& { return j.settings.integrator.name; },
      std::move(names), "what a path computes"));
  add("max-depth", &Settings::max_depth, 1, 65536, "most surface interactions of a path");
  add("roulette-depth", &Settings::roulette_depth, 0, 65536, "Russian roulette starts here");
  add("vertex-roughness", &Settings::vertex_roughness, 0.0f, 1.0f,
      "the vertex stored is the first at least this rough (diffuse is 1)");
  table.push_back(choice_option(
      "light-sampling", kTransport,
      [](Job & j) -> auto& { return j.settings.integrator.light_sampling; },
      {{"auto", LightSampling::automatic},
       {"power", LightSampling::power},
       {"tree", LightSampling::tree}},
      "how one light of many is chosen: by power, or by a tree of what each may bring to the "
      "place; auto: the tree where there are more than 32"));
  add("vpl-paths", &Settings::vpl_paths, std::uint32_t{1}, kMostLightPaths,
      "vpl: light paths of a set");
  table.push_back(choice_option(
      "vpl-set", kTransport, [](Job & j) -> auto& { return j.settings.integrator.vpl_set; },
      {{"pass", VplSet::pass}, {"pixel", VplSet::pixel}},
      "vpl: one set of light paths for all paths of a pass, or a set drawn for each"));
  add("vpl-distance", &Settings::vpl_distance, 0.0f, kLongest,
      "vpl: lights nearer to the vertex than this are bounded; 0: 6 % of its distance", "D");
  add("photon-paths", &Settings::photon_paths, std::uint32_t{1}, kMostLightPaths,
      "photon: light paths of a pass");
  add("photon-radius", &Settings::photon_radius, 0.0f, kLongest,
      "photon: of the first pass; 0: 1 % of the vertex's distance", "R");
  add("photon-delta", &Settings::photon_delta, 0.0f, 0.999f,
      "photon: pass p, from 1, has this radius / sqrt(p^delta)", "DELTA");
  add("ao-distance", &Settings::ao_distance, 1e-6f, kInfinity,
      "ao: farther surfaces do not occlude; unbounded unless given", "D");
}

void add_scene(std::vector<Option>& table) {
  Option cameras =
      parsed_option("camera", "NAME|all", kScene, "the name of a camera",
                    "camera to render, may be given again, or all; the first unless given",
                    [](Job& job, const std::string& text) {
                      job.cameras.push_back(text);
                      return true;
                    });
  cameras.is_list = true;
  table.push_back(std::move(cameras));
  table.push_back(parsed_option(
      "size", "WxH", kScene, "WxH in pixels, 1 to 65535 each", "size of the picture",
      [](Job& job, const std::string& text) { return parse_size(text, job.overrides.size); }));
  table.push_back(triple_option(
      "eye", kScene, [](SceneOverrides & s) -> auto& { return s.eye; }, "where the camera stands"));
  table.push_back(triple_option(
      "target", kScene, [](SceneOverrides & s) -> auto& { return s.target; }, "where it looks"));
  table.push_back(triple_option(
      "up", kScene, [](SceneOverrides & s) -> auto& { return s.up; }, "what is up for it"));
  table.push_back(parsed_option("fov", "DEG", kScene, "an angle between 0 and 180 degrees",
                                "horizontal field of view", [](Job& job, const std::string& text) {
                                  std::optional<float>& fov = job.overrides.fov;
                                  fov = parse_number<float>(text);
                                  return fov && *fov > 0 && *fov < 180;
                                }));
  table.push_back(
      parsed_option("shutter", "OPEN:CLOSE", kScene, "OPEN:CLOSE in frames, from -1 to 1",
                    "when the shutter of every camera opens and closes, in frames behind its frame",
                    [](Job& job, const std::string& text) {
                      return parse_shutter(text, job.overrides.shutter);
                    }));
  table.push_back(number_option(
      "fps", kScene, [](Job & j) -> auto& { return j.fps; }, 1e-3, 1e6,
      "frames a second, for the animations of glTF, which count in seconds"));
  table.push_back(parsed_option(
      "sky", "R,G,B|GREY|FILE", kScene,
      "three numbers R,G,B of at least 0 or one for grey or a picture",
      "radiance of the sky, or its equirectangular map",
      [](Job& job, const std::string& text) { return parse_sky(text, job.overrides); }));
  table.push_back(triple_option(
      "sun", kScene, [](SceneOverrides & s) -> auto& { return s.sun_direction; },
      "direction toward the sun"));
  table.push_back(parsed_option("sun-irradiance", "R,G,B|GREY", kScene, kColour,
                                "on a surface that faces it",
                                [](Job& job, const std::string& text) {
                                  const auto colour = parse_colour(text);
                                  if (colour)
                                    job.overrides.sun.emplace(colour->x, colour->y, colour->z);
                                  return colour.has_value();
                                }));
}

}  // namespace

const std::vector<Option>& option_table() {
  static const std::vector<Option> kTable = [] {
    std::vector<Option> table;
    add_output(table);
    add_sampling(table);
    add_transport(table);
    add_scene(table);
    return table;
  }();
  return kTable;
}

void set_option(Job& job, std::string_view name, const std::string& text) {
  std::string names;
  for (const Option& option : option_table()) {
    if (option.name == name) {
      if (option.set(job, text)) return;
      throw Error(ErrorCode::usage,
                  fmt::format("`{}`: expected {}, got \"{}\"", name, option.expected, text));
    }
    names += (names.empty() ? "" : ", ") + option.name;
  }
  throw Error(ErrorCode::usage, fmt::format("there is no option '{}'; there are {}", name, names));
}

}  // namespace psf::render
