#include "render/job/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/apart.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "core/json_text.h"
#include "core/output_file.h"
#include "core/seconds.h"
#include "film/attributes.h"
#include "film/image.h"
#include "film/picture_names.h"
#include "render/loop/recorder.h"

namespace psf::render {
namespace {

std::vector<std::size_t> select_cameras(const Scene& scene, const std::vector<std::string>& names) {
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

film::Image make_image(const Job& job, const Scene& scene, const Camera& camera,
                       const film::Film& film, std::uint64_t passes) {
  const RenderSettings& settings = job.settings;
  film::Image image;
  image.width = film.width();
  image.height = film.height();
  // A pixel without shaded paths gets the mean of the shaded paths around it.
  image.add("", "RGB", settings.shade_rate > 1 ? film.filled_mean() : film.mean());
  const auto& i = settings.integrator;
  image.attributes = film::attributes_of(
      job.version,
      {scene.name, scene.hash, i.name, to_string(settings.sampler.kind), settings.sampler.seed});
  const auto add = [&image](const char* name, const std::string& text) {
    image.attributes.emplace_back(std::string("psf:") + name, text);
  };
  add("enumeration", to_string(settings.sampler.enumeration));
  add("max-depth", fmt::format("{}", i.max_depth));
  add("roulette-depth", fmt::format("{}", i.roulette_depth));
  add("split", fmt::format("{}", i.split));
  add("shade-rate", fmt::format("1/{}", settings.shade_rate));
  if (i.name == "ao" && std::isfinite(i.ao_distance)) {
    add("ao-distance", fmt::format("{}", i.ao_distance));
  }
  if (i.name == "vpl") {
    add("vpl-paths", fmt::format("{}", i.vpl_paths));
    add("vpl-set", i.vpl_set == VplSet::pass ? "pass" : "pixel");
    add("vpl-distance", fmt::format("{}", i.vpl_distance));
  }
  if (i.name == "photon") {
    add("photon-paths", fmt::format("{}", i.photon_paths));
    add("photon-radius", fmt::format("{}", i.photon_radius));
    add("photon-delta", fmt::format("{}", i.photon_delta));
  }
  film::add_picture(image.attributes, camera.name, 0, passes);
  return image;
}

// A dump that goes on is an output alone. `inputs`: beside those of the job.
void check_all_files(const Job& job, std::vector<std::string> inputs,
                     std::vector<std::string> outputs) {
  inputs.insert(inputs.end(), {job.scene, job.overrides.sky_map.value_or("")});
  outputs.push_back(job.output);
  outputs.insert(outputs.end(), job.other_outputs.begin(), job.other_outputs.end());
  core::check_files(inputs, outputs);
}

// A dump whose vertices are all in one place has nothing to filter.
void check_digits(const Job& job, const Scene& scene) {
  const WorldDigits digits = world_digits(scene);
  if (digits.steps() >= 1) return;
  throw Error(ErrorCode::limit,
              fmt::format("{}: the scene is {:.3g} across and {:.3g} from the origin, where the "
                          "positions of a dump keep {:.3g} of a unit: its vertices would all be in "
                          "one place; move the scene nearer, or write `image` alone",
                          job.scene, digits.across, digits.reach, digits.step));
}

void note(const Job& job, const std::string& text) {
  if (job.on_note) job.on_note(text);
}

// With `resume` a file that is there goes on; one that is not is begun.
formats::Writer open_writer(const Job& job, const formats::Head& head) {
  formats::WriterOptions options;
  options.codec = job.codec;
  const std::string path = core::followed(job.output);
  if (!job.resume || !std::filesystem::exists(path)) return {path, head, options};
  formats::Writer writer = formats::Writer::resume(path, head, options);
  note(job,
       fmt::format("{} has {} of {} passes", job.output, writer.passes(), job.settings.passes));
  return writer;
}

std::vector<std::string> write_images(const Job& job, const Scene& scene,
                                      const std::vector<std::size_t>& cameras,
                                      const film::PictureNames& names, const RenderResult& result) {
  std::vector<std::string> images;
  if (job.images.empty()) return images;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const film::Image image =
        make_image(job, scene, scene.cameras[cameras[k]], result.films[k], result.passes);
    for (std::size_t output = 0; output < names.count(); ++output) {
      images.push_back(names.path(output, k, 0));
      film::write_image(images.back(), image);
    }
  }
  return images;
}

void check_names(const Job& job) {
  if (!job.output.empty() && std::filesystem::path(job.output).extension() != ".pvb") {
    throw Error(ErrorCode::usage,
                job.output + ": a path-vertex buffer is named .pvb; `image` writes pictures");
  }
  for (const std::string& image : job.images) film::check_image_path(image);
  static_cast<void>(record_channels(job.settings.channels));
}

}  // namespace

JobResult run_job(const Job& asked) {
  check_names(asked);
  check_all_files(asked, {}, asked.images);  // what can be said before anything is loaded
  const core::Clock::time_point start = core::Clock::now();
  Job job = asked;
  const Scene scene = load_scene(job.scene, job.overrides);
  RenderSettings& settings = job.settings;
  settings.producer = "psf-render " + job.version;
  settings.cameras = select_cameras(scene, job.cameras);
  settings.validate(scene);
  const auto integrator = make_integrator(scene, settings.integrator);
  settings.replay = !job.images.empty();
  std::optional<formats::Writer> writer;
  const std::vector<std::size_t> cameras = chosen_cameras(scene, settings);
  std::vector<std::string> camera_names;
  camera_names.reserve(cameras.size());
  for (const std::size_t camera : cameras) camera_names.push_back(scene.cameras[camera].name);
  const film::PictureNames names(job.images, camera_names);
  check_all_files(job, scene.files, names.all({}));
  if (!job.output.empty()) {
    check_digits(job, scene);
    writer.emplace(open_writer(job, make_head(scene, *integrator, settings)));
  }
  for (const std::string& warning : scene.warnings) note(job, warning);
  JobResult result;
  result.scene = scene.name;
  result.prepare_seconds = core::seconds_since(start);
  core::throw_if_interrupted("nothing was rendered, nothing is written");
  result.render = render(scene, *integrator, settings, writer ? &*writer : nullptr);
  result.images = write_images(job, scene, cameras, names, result.render);
  if (writer) result.bytes = writer->bytes_written();
  return result;
}

double JobResult::rays_per_second() const {
  return static_cast<double>(render.rays) / std::max(1e-9, render.seconds);
}

void throw_if_stopped(const Job& job, const JobResult& result) {
  if (!result.render.interrupted) return;
  const std::string kept = result.bytes ? job.output + " keeps" : "the pictures keep";
  throw Error(ErrorCode::interrupted,
              fmt::format("interrupted after pass {} of {}: {} all {} paths of them{}",
                          result.render.passes, job.settings.passes, kept, result.render.paths,
                          result.bytes ? "; `resume` goes on" : ""));
}

std::string figures(const Job& job, const JobResult& result) {
  const RenderResult& r = result.render;
  nlohmann::ordered_json json = {{"scene", result.scene},
                                 {"passes", r.passes},
                                 {"paths", r.paths},
                                 {"rays", r.rays},
                                 {"prepare_seconds", result.prepare_seconds},
                                 {"seconds", r.seconds},
                                 {"output_seconds", r.output_seconds},
                                 {"rays_per_second", result.rays_per_second()},
                                 {"non_finite", r.non_finite},
                                 {"interrupted", r.interrupted},
                                 {"images", result.images}};
  if (result.bytes) {
    json["file"] = job.output;
    json["bytes"] = *result.bytes;
  }
  return core::json_text(json, 2);
}

}  // namespace psf::render
