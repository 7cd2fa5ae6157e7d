// psf-render: renders a scene into a path-vertex buffer.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/standard_streams.h"
#include "film/attributes.h"
#include "film/image.h"
#include "film/picture_names.h"
#include "psf-render/options.h"
#include "render/loop/render.h"
#include "version.h"

namespace psf::tools {
namespace {

std::vector<std::size_t> select_cameras(const render::Scene& scene,
                                        const std::vector<std::string>& names) {
  if (names.empty()) return {0};
  std::vector<std::size_t> result;
  for (const std::string& name : names) {
    if (name == "all") return {};
    std::string known;
    std::size_t found = scene.cameras.size();
    for (std::size_t k = scene.cameras.size(); k-- > 0;) {
      if (scene.cameras[k].name == name) found = k;
      known = scene.cameras[k].name + (known.empty() ? "" : ", ") + known;
    }
    if (found == scene.cameras.size()) {
      throw Error(ErrorCode::usage, fmt::format("{}: no camera is called \"{}\"; its cameras: {}",
                                                scene.name, name, known));
    }
    if (std::find(result.begin(), result.end(), found) == result.end()) result.push_back(found);
  }
  return result;
}

film::Image make_image(const render::Scene& scene, const render::Camera& camera,
                       const film::Film& film, const render::RenderSettings& settings,
                       std::uint64_t passes) {
  film::Image image;
  image.width = film.width();
  image.height = film.height();
  // A pixel without shaded paths gets the mean of the shaded paths around it.
  image.add("", "RGB", settings.shade_rate > 1 ? film.filled_mean() : film.mean());
  const auto& i = settings.integrator;
  image.attributes = film::attributes_of(
      kVersion, {scene.name, scene.hash, i.name, render::to_string(settings.sampler.kind),
                 settings.sampler.seed});
  const auto add = [&image](const char* name, const std::string& text) {
    image.attributes.emplace_back(std::string("psf:") + name, text);
  };
  add("enumeration", render::to_string(settings.sampler.enumeration));
  add("max-depth", fmt::format("{}", i.max_depth));
  add("roulette-depth", fmt::format("{}", i.roulette_depth));
  add("split", fmt::format("{}", i.split));
  add("shade-rate", fmt::format("1/{}", settings.shade_rate));
  if (i.name == "ao" && std::isfinite(i.ao_distance)) {
    add("ao-distance", fmt::format("{}", i.ao_distance));
  }
  film::add_picture(image.attributes, camera.name, 0, passes);
  return image;
}

std::string format_bytes(double bytes) {
  if (bytes >= 1e9) return fmt::format("{:.2f} GB", bytes / 1e9);
  if (bytes >= 1e6) return fmt::format("{:.1f} MB", bytes / 1e6);
  return fmt::format("{:.1f} kB", bytes / 1e3);
}

// A dump that goes on is an output alone. `inputs`: beside those of the command line.
void check_all_files(const RenderOptions& options, std::vector<std::string> inputs,
                     std::vector<std::string> outputs) {
  inputs.insert(inputs.end(), {options.scene, options.overrides.sky_map.value_or("")});
  outputs.insert(outputs.end(), {options.output, options.common.json});
  check_files(inputs, outputs);
}

// A dump whose vertices are all in one place has nothing to filter.
void check_digits(const RenderOptions& options, const render::Scene& scene) {
  const render::WorldDigits digits = render::world_digits(scene);
  if (digits.steps() >= 1) return;
  throw Error(ErrorCode::limit,
              fmt::format("{}: the scene is {:.3g} across and {:.3g} from the origin, where the "
                          "positions of a dump keep {:.3g} of a unit: its vertices would all be in "
                          "one place; move the scene nearer, or write --image alone",
                          options.scene, digits.across, digits.reach, digits.step));
}

// With --resume a file that is there goes on; one that is not is begun.
formats::Writer open_writer(const RenderOptions& options, const formats::Head& head) {
  formats::WriterOptions writer_options;
  writer_options.codec = options.codec;
  const std::string path = core::followed(options.output);
  if (!options.resume || !std::filesystem::exists(path)) return {path, head, writer_options};
  formats::Writer writer = formats::Writer::resume(path, head, writer_options);
  if (!options.common.quiet) {
    core::say(fmt::format("note: {} has {} of {} passes", options.output, writer.passes(),
                          options.settings.passes));
  }
  return writer;
}

void run(RenderOptions& options) {
  const core::ThreadLimit threads(options.common.threads);
  check_outputs(options);
  check_all_files(options, {}, options.images);  // what can be said before anything is loaded
  const auto start = std::chrono::steady_clock::now();
  const render::Scene scene = render::load_scene(options.scene, options.overrides);
  auto& settings = options.settings;
  settings.producer = std::string("psf-render ") + kVersion;
  settings.quiet = options.common.quiet;
  settings.cameras = select_cameras(scene, options.cameras);
  settings.validate(scene);
  const auto integrator = render::make_integrator(scene, settings.integrator);
  settings.replay = !options.images.empty();
  std::optional<formats::Writer> writer;
  const auto cameras = render::chosen_cameras(scene, settings);
  std::vector<std::string> camera_names;
  for (const std::size_t camera : cameras) camera_names.push_back(scene.cameras[camera].name);
  const film::PictureNames names(options.images, camera_names);
  check_all_files(options, scene.files, names.all({}));
  if (!options.output.empty()) {
    check_digits(options, scene);
    writer.emplace(open_writer(options, render::make_head(scene, *integrator, settings)));
  }
  if (!options.common.quiet) {
    for (const std::string& warning : scene.warnings) core::say("note: " + warning);
  }
  const double prepared =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  core::throw_if_interrupted("nothing was rendered, nothing is written");

  const render::RenderResult result =
      render::render(scene, *integrator, settings, writer ? &*writer : nullptr);

  std::vector<std::string> images;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const render::Camera& camera = scene.cameras[cameras[k]];
    if (options.images.empty()) break;
    const film::Image image = make_image(scene, camera, result.films[k], settings, result.passes);
    for (std::size_t output = 0; output < names.count(); ++output) {
      images.push_back(names.path(output, k, 0));
      film::write_image(images.back(), image);
    }
  }

  const double rate = static_cast<double>(result.rays) / std::max(1e-9, result.seconds);
  fmt::print("{}: {} passes, {} paths, {} rays in {:.2f} s, {:.2f} M rays/s\n", scene.name,
             result.passes, result.paths, result.rays, result.seconds, rate / 1e6);
  if (writer) {
    fmt::print("{}: {}\n", options.output,
               format_bytes(static_cast<double>(writer->bytes_written())));
  }
  for (const std::string& image : images) fmt::print("{}\n", image);
  if (result.non_finite != 0 && !options.common.quiet) {
    core::say(
        fmt::format("note: {} paths are not finite; pictures leave them out, the dump keeps them",
                    result.non_finite));
  }
  if (!options.common.json.empty()) {
    nlohmann::ordered_json figures = {{"scene", scene.name},
                                      {"passes", result.passes},
                                      {"paths", result.paths},
                                      {"rays", result.rays},
                                      {"prepare_seconds", prepared},
                                      {"seconds", result.seconds},
                                      {"output_seconds", result.output_seconds},
                                      {"rays_per_second", rate},
                                      {"non_finite", result.non_finite},
                                      {"interrupted", result.interrupted},
                                      {"images", images}};
    if (writer) {
      figures["file"] = options.output;
      figures["bytes"] = writer->bytes_written();
    }
    core::write_json_file(options.common.json, figures);
  }
  if (result.interrupted) {
    const std::string kept = writer ? options.output + " keeps" : "the pictures keep";
    throw Error(
        ErrorCode::interrupted,
        fmt::format("interrupted after pass {} of {}: {} all {} paths of them{}", result.passes,
                    settings.passes, kept, result.paths, writer ? "; --resume goes on" : ""));
  }
}

}  // namespace
}  // namespace psf::tools

int main(int argc, char** argv) {
  CLI::App app(
      "Renders a scene and writes one record per light transport path to a path-vertex buffer,\n"
      "which psf filters.\n",
      "psf-render");
  psf::tools::RenderOptions options;
  psf::tools::add_render_options(app, options);
  psf::tools::set_example(app,
                          "psf-render sample_data/cornell.json -o cornell.pvb --image cornell.png");
  app.callback([&options] { psf::tools::run(options); });
  return psf::tools::run_tool(app, argc, argv);
}
