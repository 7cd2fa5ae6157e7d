#include "render/job/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/number.h"

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

// "1,2,3"
template <class T>
std::optional<Imath::Vec3<T>> parse_triple(std::string_view text) {
  Imath::Vec3<T> result;
  for (int k = 0; k < 3; ++k) {
    const std::size_t end = k < 2 ? text.find(',') : text.size();
    if (end == std::string_view::npos) return std::nullopt;
    const auto number = parse_number<T>(text.substr(0, end));
    if (!number) return std::nullopt;
    result[k] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

// "1,2,3", or one number for grey, of at least 0.
std::optional<Vec3> parse_colour(std::string_view text) {
  const auto grey = parse_number<float>(text);
  auto colour = grey ? std::optional(Vec3(*grey)) : parse_triple<float>(text);
  if (!colour || !(colour->x >= 0 && colour->y >= 0 && colour->z >= 0)) return std::nullopt;
  return colour;
}

bool parse_size(const std::string& text, std::optional<Vec2>& size) {
  const std::size_t x = text.find('x');
  if (x == std::string::npos) return false;
  const auto width = parse_number<std::uint16_t>(std::string_view(text).substr(0, x));
  const auto height = parse_number<std::uint16_t>(std::string_view(text).substr(x + 1));
  if (!width || !height || *width == 0 || *height == 0) return false;
  size.emplace(static_cast<float>(*width), static_cast<float>(*height));
  return true;
}

bool parse_shade_rate(const std::string& text, std::uint32_t& rate) {
  if (text == "1") return rate = 1, true;
  if (!text.starts_with("1/")) return false;
  const auto k = parse_number<std::uint32_t>(std::string_view(text).substr(2));
  if (!k || *k == 0 || *k > kMostShadeRate) return false;
  rate = *k;
  return true;
}

// A colour, or else the name of a picture; text made of numbers alone is never taken for a name.
bool parse_sky(const std::string& text, SceneOverrides& overrides) {
  if (const auto colour = parse_colour(text)) {
    overrides.sky.emplace(colour->x, colour->y, colour->z);
    return true;
  }
  if (text.find_first_not_of("0123456789.,+- ") == std::string::npos) return false;
  overrides.sky_map = text;
  return true;
}

// A number of a job from `least` to `most`.
template <class Member, class T = std::decay_t<std::invoke_result_t<Member, Job&>>>
Option number(const char* name, const char* group, Member member, T least, T most, const char* help,
              const char* type = "N") {
  const bool bounded = most < std::numeric_limits<T>::max();
  Option option{name, type, group, help};
  option.expected = fmt::format(
      "{} {}", std::is_integral_v<T> ? "a whole number" : "a number",
      bounded ? fmt::format("from {} to {}", least, most) : fmt::format("of at least {}", least));
  Job standard;
  const T value = member(standard);
  if (std::isfinite(static_cast<double>(value))) option.standard = fmt::format("{}", value);
  option.set = [member, least, most](Job& job, const std::string& text) {
    const auto given = parse_number<T>(text);
    if (!given || *given < least || *given > most) return false;
    member(job) = *given;
    return true;
  };
  return option;
}

template <class Member, class T = std::decay_t<std::invoke_result_t<Member, Job&>>>
Option choice(const char* name, const char* group, Member member,
              std::vector<std::pair<std::string, T>> choices, const char* help) {
  Option option{name, "", group, help};
  Job standard;
  for (const auto& [text, value] : choices) {
    option.type += (option.type.empty() ? "" : "|") + text;
    if (value == member(standard)) option.standard = text;
  }
  option.expected = "one of " + option.type;
  option.set = [member, choices = std::move(choices)](Job& job, const std::string& text) {
    const auto found = std::find_if(choices.begin(), choices.end(),
                                    [&](const auto& one) { return one.first == text; });
    if (found == choices.end()) return false;
    member(job) = found->second;
    return true;
  };
  return option;
}

// Three numbers of the overrides.
template <class Member>
Option triple(const char* name, Member member, const char* help) {
  Option option{name, "X,Y,Z", kScene, help, "three numbers X,Y,Z"};
  option.set = [member](Job& job, const std::string& text) {
    auto& target = member(job.overrides);
    using Number = std::decay_t<decltype(target->x)>;
    const auto parsed = parse_triple<Number>(text);
    if (parsed) target.emplace(parsed->x, parsed->y, parsed->z);
    return parsed.has_value();
  };
  return option;
}

template <class Set>
Option parsed(const char* name, const char* type, const char* group, std::string expected,
              const char* help, Set set, const char* standard = "") {
  Option option{name, type, group, help, std::move(expected), standard};
  option.set = std::move(set);
  return option;
}

void add_output(std::vector<Option>& table) {
  table.push_back(choice(
      "codec", kOutput, [](Job & j) -> auto& { return j.codec; },
      {{"raw", formats::Codec::raw}, {"zstd", formats::Codec::zstd}}, "how columns are stored"));
  Option channels = parsed(
      "channels", "NAME,...", kOutput, "names of channels",
      "optional channels to write, comma-separated: default, which is normal, reflectance, "
      "camera, visibility, hit_distance, direction, material, roughness, in scenes with volumes "
      "kind, and what there is unless given; film, lens, time, frame, alpha, kind; or all",
      [](Job& job, const std::string& text) {
        job.settings.channels.push_back(text);
        return true;
      });
  channels.is_list = true;
  channels.separator = ',';
  table.push_back(std::move(channels));
  table.push_back(choice(
      "layers", kOutput, [](Job & j) -> auto& { return j.settings.integrator.layers; },
      {{"none", LayerKind::none},
       {"lights", LayerKind::lights},
       {"bounces", LayerKind::bounces},
       {"lobes", LayerKind::lobes}},
      "also write the light by lights, by direct and indirect, or by diffuse and glossy"));
  table.push_back(
      parsed("vertices", "all|N", kOutput, "all or a whole number of at least 1",
             "also write every vertex of every path, or its first N, as the table vertices",
             [](Job& job, const std::string& text) {
               const auto most =
                   text == "all" ? std::optional(kAllVertices) : parse_number<std::uint32_t>(text);
               if (!most || *most == 0) return false;
               job.settings.integrator.vertices = *most;
               return true;
             }));
  table.push_back(number(
      "photons", kOutput, [](Job & j) -> auto& { return j.settings.integrator.photons; },
      std::uint32_t{0}, kMostLightPaths,
      "also write the vertices of N paths from the lights a pass, as the table photons"));
}

void add_sampling(std::vector<Option>& table) {
  constexpr std::uint64_t kMany = std::numeric_limits<std::uint32_t>::max();
  table.push_back(number(
      "passes", kSampling, [](Job & j) -> auto& { return j.settings.passes; }, std::uint64_t{1},
      kMany, "paths a pixel"));
  table.push_back(choice(
      "sampler", kSampling, [](Job & j) -> auto& { return j.settings.sampler.kind; },
      {{"sobol", SamplerKind::sobol},
       {"halton", SamplerKind::halton},
       {"independent", SamplerKind::independent}},
      "where the numbers come from; sobol and halton are Owen-scrambled"));
  table.push_back(choice(
      "enumeration", kSampling, [](Job & j) -> auto& { return j.settings.sampler.enumeration; },
      {{"pixel", Enumeration::pixel}, {"global", Enumeration::global}},
      "pixel: each has its own sequence, a pass visits them in order; global: one sequence "
      "over the picture, so that blocks of 2^m paths are nets"));
  table.push_back(number(
      "seed", kSampling, [](Job & j) -> auto& { return j.settings.sampler.seed; }, std::uint64_t{0},
      std::numeric_limits<std::uint64_t>::max(), "of the randomisation"));
  table.push_back(number(
      "split", kSampling, [](Job & j) -> auto& { return j.settings.integrator.split; },
      std::uint32_t{1}, std::uint32_t{65536},
      "continue every path so many times from its vertex, store the mean"));
  table.push_back(parsed(
      "shade-rate", "1/K", kSampling, fmt::format("1 or 1/K, K up to {}", kMostShadeRate),
      "shade one path in K; the others have a vertex and its shadow rays alone",
      [](Job& job, const std::string& text) {
        return parse_shade_rate(text, job.settings.shade_rate);
      },
      "1"));
  table.push_back(number(
      "time-limit", kSampling, [](Job & j) -> auto& { return j.settings.time_limit; }, 1e-3,
      std::numeric_limits<double>::infinity(), "seconds; ends after the pass that reaches it",
      "S"));
}

void add_transport(std::vector<Option>& table) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const std::string& name : integrator_names()) names.emplace_back(name, name);
  const auto add = [&table](const char* name, auto member, auto least, auto most, const char* help,
                            const char* type = "N") {
    table.push_back(number(
        name, kTransport, [member](Job & j) -> auto& { return j.settings.integrator.*member; },
        least, most, help, type));
  };
  using Settings = IntegratorSettings;
  table.push_back(choice(
      "integrator", kTransport, [](Job & j) -> auto& { return j.settings.integrator.name; },
      std::move(names), "what a path computes"));
  add("max-depth", &Settings::max_depth, 1, 65536, "most surface interactions of a path");
  add("roulette-depth", &Settings::roulette_depth, 0, 65536, "Russian roulette starts here");
  add("vertex-roughness", &Settings::vertex_roughness, 0.0f, 1.0f,
      "the vertex stored is the first at least this rough (diffuse is 1)");
  add("vpl-paths", &Settings::vpl_paths, std::uint32_t{1}, kMostLightPaths,
      "vpl: light paths of a set");
  table.push_back(choice(
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
      "photon: pass p has this radius / sqrt(p^delta)", "DELTA");
  add("ao-distance", &Settings::ao_distance, 1e-6f, kInfinity,
      "ao: farther surfaces do not occlude; unbounded unless given", "D");
}

void add_scene(std::vector<Option>& table) {
  Option cameras = parsed("camera", "NAME|all", kScene, "the name of a camera",
                          "camera to render, may be given again, or all; the first unless given",
                          [](Job& job, const std::string& text) {
                            job.cameras.push_back(text);
                            return true;
                          });
  cameras.is_list = true;
  table.push_back(std::move(cameras));
  table.push_back(parsed(
      "size", "WxH", kScene, "WxH in pixels, 1 to 65535 each", "size of the picture",
      [](Job& job, const std::string& text) { return parse_size(text, job.overrides.size); }));
  table.push_back(triple(
      "eye", [](SceneOverrides & s) -> auto& { return s.eye; }, "where the camera stands"));
  table.push_back(triple(
      "target", [](SceneOverrides & s) -> auto& { return s.target; }, "where it looks"));
  table.push_back(triple(
      "up", [](SceneOverrides & s) -> auto& { return s.up; }, "what is up for it"));
  table.push_back(parsed("fov", "DEG", kScene, "an angle between 0 and 180 degrees",
                         "horizontal field of view", [](Job& job, const std::string& text) {
                           std::optional<float>& fov = job.overrides.fov;
                           fov = parse_number<float>(text);
                           return fov && *fov > 0 && *fov < 180;
                         }));
  table.push_back(
      parsed("sky", "R,G,B|GREY|FILE", kScene,
             "three numbers R,G,B of at least 0 or one for grey or a picture",
             "radiance of the sky, or its equirectangular map",
             [](Job& job, const std::string& text) { return parse_sky(text, job.overrides); }));
  table.push_back(triple(
      "sun", [](SceneOverrides & s) -> auto& { return s.sun_direction; },
      "direction toward the sun"));
  table.push_back(parsed("sun-irradiance", "R,G,B|GREY", kScene, kColour,
                         "on a surface that faces it", [](Job& job, const std::string& text) {
                           const auto colour = parse_colour(text);
                           if (colour) job.overrides.sun.emplace(colour->x, colour->y, colour->z);
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
