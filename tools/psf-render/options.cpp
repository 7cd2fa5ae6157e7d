// Declares the options of psf-render and turns their text into values.
#include "psf-render/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "build_info.h"
#include "core/error.h"
#include "core/output_file.h"
#include "film/image.h"
#include "option_values.h"
#include "render/loop/recorder.h"

namespace psf::tools {
namespace {

using render::Enumeration;
using render::SamplerKind;

constexpr const char* kColour = "three numbers R,G,B of at least 0 or one for grey";

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
  const auto colour = grey ? std::optional(Vec3(*grey)) : parse_triple<float>(text);
  if (!colour || !(colour->x >= 0 && colour->y >= 0 && colour->z >= 0)) return std::nullopt;
  return colour;
}

template <class Target>
CLI::Option* add_triple(CLI::App& app, const std::string& name, Target& target, bool colour,
                        const std::string& help) {
  return add_parsed(app, name, colour ? "R,G,B|GREY" : "X,Y,Z",
                    colour ? kColour : "three numbers X,Y,Z", help,
                    [&target, colour](const std::string& text) {
                      using Number = std::decay_t<decltype(target->x)>;
                      std::optional<Imath::Vec3<Number>> triple;
                      if (!colour) {
                        triple = parse_triple<Number>(text);
                      } else if (const auto c = parse_colour(text)) {
                        triple.emplace(*c);
                      }
                      if (!triple) return false;
                      target.emplace(triple->x, triple->y, triple->z);
                      return true;
                    });
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
  if (!k || *k == 0 || *k > 65536) return false;
  rate = *k;
  return true;
}

// A colour, or else the name of a picture; text made of numbers alone is never taken for a name.
bool parse_sky(const std::string& text, render::SceneOverrides& overrides) {
  if (const auto colour = parse_colour(text)) {
    overrides.sky.emplace(colour->x, colour->y, colour->z);
    return true;
  }
  if (text.find_first_not_of("0123456789.,+- ") == std::string::npos) return false;
  overrides.sky_map = text;
  return true;
}

void add_outputs(CLI::App& app, RenderOptions& o) {
  constexpr auto kGroup = "Output";
  app.add_option("SCENE", o.scene, "scene file: .json of ours, .obj, .gltf or .glb")
      ->required()
      ->type_name("");
  app.add_option("-o,--output", o.output, "path-vertex buffer to write")
      ->type_name("OUT.pvb")
      ->group(kGroup);
  app.add_flag("--resume", o.resume,
               "go on with OUT.pvb where it ends, after ^C, a kill, a time limit or to add passes; "
               "begin it where it is not there")
      ->group(kGroup);
  app.add_option("--image", o.images,
                 "unfiltered picture, .exr or .png; may be given again; with several cameras each "
                 "adds its name")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->group(kGroup);
  add_choice(app, "--codec", o.codec,
             {{"raw", formats::Codec::raw}, {"zstd", formats::Codec::zstd}},
             "how columns are stored")
      ->group(kGroup);
  app.add_option("--channels", o.settings.channels,
                 "optional channels to write, comma-separated: normal, reflectance, camera, "
                 "visibility, hit_distance, direction, material, roughness; all unless given")
      ->delimiter(',')
      ->type_name("NAME,...")
      ->group(kGroup);
}

void add_sampling(CLI::App& app, RenderOptions& o) {
  constexpr auto kGroup = "Sampling";
  constexpr auto kMany = std::numeric_limits<std::uint32_t>::max();
  auto& s = o.settings;
  add_number<std::uint64_t>(app, "--passes", s.passes, 1, kMany, "paths a pixel")->group(kGroup);
  add_choice(app, "--sampler", s.sampler.kind,
             {{"sobol", SamplerKind::sobol},
              {"halton", SamplerKind::halton},
              {"independent", SamplerKind::independent}},
             "where the numbers come from; sobol and halton are Owen-scrambled")
      ->group(kGroup);
  add_choice(app, "--enumeration", s.sampler.enumeration,
             {{"pixel", Enumeration::pixel}, {"global", Enumeration::global}},
             "pixel: each has its own sequence, a pass visits them in order; global: one sequence "
             "over the picture, so that blocks of 2^m paths are nets")
      ->group(kGroup);
  add_number<std::uint64_t>(app, "--seed", s.sampler.seed, 0,
                            std::numeric_limits<std::uint64_t>::max(), "of the randomisation")
      ->group(kGroup);
  add_number<std::uint32_t>(app, "--split", s.integrator.split, 1, 65536,
                            "continue every path so many times from its vertex, store the mean")
      ->group(kGroup);
  add_parsed(app, "--shade-rate", "1/K", "1 or 1/K, K up to 65536",
             "shade one path in K; the others have a vertex and its shadow rays alone",
             [&s](const std::string& text) { return parse_shade_rate(text, s.shade_rate); })
      ->default_str("1")
      ->group(kGroup);
  add_number(app, "--time-limit", s.time_limit, 1e-3, std::numeric_limits<double>::infinity(),
             "seconds; ends after the pass that reaches it")
      ->type_name("S")
      ->group(kGroup);
}

void add_transport(CLI::App& app, RenderOptions& o) {
  constexpr auto kGroup = "Light transport";
  auto& i = o.settings.integrator;
  std::vector<std::pair<std::string, std::string>> names;
  for (const std::string& name : render::integrator_names()) names.emplace_back(name, name);
  add_choice(app, "--integrator", i.name, names, "what a path computes")->group(kGroup);
  add_number(app, "--max-depth", i.max_depth, 1, 65536, "most surface interactions of a path")
      ->group(kGroup);
  add_number(app, "--roulette-depth", i.roulette_depth, 0, 65536, "Russian roulette starts here")
      ->group(kGroup);
  add_number(app, "--vertex-roughness", i.vertex_roughness, 0.0f, 1.0f,
             "the vertex stored is the first at least this rough (diffuse is 1)")
      ->group(kGroup);
  add_number(app, "--ao-distance", i.ao_distance, 1e-6f, std::numeric_limits<float>::infinity(),
             "ao: farther surfaces do not occlude; unbounded unless given")
      ->type_name("D")
      ->group(kGroup);
}

void add_scene(CLI::App& app, RenderOptions& o) {
  constexpr auto kGroup = "Camera and light, over those of the scene";
  auto& s = o.overrides;
  app.add_option("--camera", o.cameras,
                 "camera to render, may be given again, or all; the first unless given")
      ->type_name("NAME|all")
      ->allow_extra_args(false)
      ->group(kGroup);
  add_parsed(app, "--size", "WxH", "WxH in pixels, 1 to 65535 each", "size of the picture",
             [&s](const std::string& text) { return parse_size(text, s.size); })
      ->group(kGroup);
  add_triple(app, "--eye", s.eye, false, "where the camera stands")->group(kGroup);
  add_triple(app, "--target", s.target, false, "where it looks")->group(kGroup);
  add_triple(app, "--up", s.up, false, "what is up for it")->group(kGroup);
  add_parsed(app, "--fov", "DEG", "an angle between 0 and 180 degrees", "horizontal field of view",
             [&s](const std::string& text) {
               s.fov = parse_number<float>(text);
               return s.fov && *s.fov > 0 && *s.fov < 180;
             })
      ->group(kGroup);
  add_parsed(app, "--sky", "R,G,B|GREY|FILE", std::string(kColour) + " or a picture",
             "radiance of the sky, or its equirectangular map",
             [&s](const std::string& text) { return parse_sky(text, s); })
      ->group(kGroup);
  add_triple(app, "--sun", s.sun_direction, false, "direction toward the sun")->group(kGroup);
  add_triple(app, "--sun-irradiance", s.sun, true, "on a surface that faces it")->group(kGroup);
}

}  // namespace

void add_render_options(CLI::App& app, RenderOptions& options) {
  // What every program has comes last: the page begins with what this one is for.
  app.set_help_flag();
  add_outputs(app, options);
  add_sampling(app, options);
  add_transport(app, options);
  add_scene(app, options);
  app.option_defaults()->group("General");
  add_common(app, options.common);
  app.set_help_flag("-h,--help", "print this and exit");
  app.set_version_flag(
      "--version", [] { return version_text("psf-render"); }, "print it and exit");
  wrap_descriptions(app);
}

void check_outputs(const RenderOptions& options) {
  if (options.output.empty() && options.images.empty()) {
    throw Error(ErrorCode::usage, "nothing to write: give -o OUT.pvb, --image FILE or both");
  }
  if (options.resume && options.output.empty()) {
    throw Error(ErrorCode::usage, "--resume needs the file to go on with: give -o OUT.pvb");
  }
  if (!options.output.empty()) {
    if (std::filesystem::path(options.output).extension() != ".pvb") {
      throw Error(ErrorCode::usage, options.output +
                                        ": a path-vertex buffer is named .pvb; --image "
                                        "writes pictures");
    }
  }
  for (const std::string& image : options.images) film::check_image_path(image);
  (void)render::record_channels(options.settings.channels);
}

}  // namespace psf::tools
