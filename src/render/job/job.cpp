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
#include "render/job/frames.h"
#include "render/loop/recorder.h"

namespace psf::render {
namespace {

namespace fs = std::filesystem;

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
  if (i.light_sampling != LightSampling::automatic) {
    add("light-sampling", i.light_sampling == LightSampling::power ? "power" : "tree");
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
  if (settings.frames) add("frame", fmt::format("{}", scene.moment.frame));
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
  note(job, fmt::format("{} has {} of {} passes", job.output, writer.passes(),
                        job.settings.total_passes()));
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
  if (job.settings.frames) check_frame_names(job);
}

// The scene at a frame of the job, with its integrator.
struct Shot {
  Shot(const Job& job, std::uint32_t frame)
      : scene(load_scene(job.scene, job.overrides, {static_cast<double>(frame), job.fps},
                         has_channel(job.settings.channels, kRestPosition))),
        integrator(make_integrator(scene, job.settings.integrator)) {}
  Scene scene;
  std::unique_ptr<const Integrator> integrator;
};

// A job whose files are checked: shot by shot, of which one file or none gets all.
class Run {
 public:
  explicit Run(const Job& job) : job_(job), range_(job.settings.frame_range()) {}
  JobResult run();

 private:
  void begin(const Shot& first);
  void shoot(std::uint32_t index, const Shot& shot);
  [[nodiscard]] film::PictureNames names(std::uint32_t index) const;

  Job job_;
  FrameRange range_;
  core::Clock::time_point start_ = core::Clock::now();
  std::vector<std::size_t> cameras_;
  std::vector<std::string> camera_names_;
  formats::Head head_;
  std::optional<formats::Writer> writer_;
  JobResult result_;
};

film::PictureNames Run::names(std::uint32_t index) const {
  std::vector<std::string> images = job_.images;
  if (job_.settings.frames) {
    for (std::string& image : images) image = numbered(image, range_.first + index);
  }
  return {images, camera_names_};
}

// Settles what all frames share, and opens the file.
void Run::begin(const Shot& first) {
  RenderSettings& settings = job_.settings;
  const Scene& scene = first.scene;
  settings.producer = "psf-render " + job_.version;
  settings.cameras = select_cameras(scene, job_.cameras);
  settings.validate(scene);
  settings.replay = !job_.images.empty();
  cameras_ = chosen_cameras(scene, settings);
  for (const std::size_t camera : cameras_) camera_names_.push_back(scene.cameras[camera].name);
  std::vector<std::string> pictures;
  for (std::uint32_t k = 0; k < range_.count && !job_.images.empty(); ++k) {
    const std::vector<std::string> of_frame = names(k).all({});
    pictures.insert(pictures.end(), of_frame.begin(), of_frame.end());
  }
  check_all_files(job_, scene.files, pictures);
  if (job_.output.empty()) return;
  check_digits(job_, scene);
  std::vector<std::vector<Camera>> cameras;
  for (std::uint32_t k = 0; k < range_.count && range_.count > 1; ++k) {
    cameras.push_back(
        cameras_at(job_.scene, job_.overrides, scene, static_cast<double>(range_.first + k)));
  }
  head_ = make_head(scene, *first.integrator, settings, cameras);
  writer_.emplace(open_writer(job_, head_));
}

void Run::shoot(std::uint32_t index, const Shot& shot) {
  const bool is_first = result_.render.films.empty();
  const RenderResult before = std::move(result_.render);
  result_.render =
      render(shot.scene, *shot.integrator, job_.settings, writer_ ? &*writer_ : nullptr,
             {index, &head_, is_first ? nullptr : &before});
  // ^C may have ended its first pass.
  if (result_.render.passes <= index * job_.settings.passes) return;
  const std::vector<std::string> images =
      write_images(job_, shot.scene, cameras_, names(index), result_.render);
  result_.images.insert(result_.images.end(), images.begin(), images.end());
}

JobResult Run::run() {
  auto shot = std::make_unique<const Shot>(job_, range_.first);
  begin(*shot);
  for (const std::string& warning : shot->scene.warnings) note(job_, warning);
  result_.scene = shot->scene.name;
  result_.prepare_seconds = core::seconds_since(start_);
  core::throw_if_interrupted("nothing was rendered, nothing is written");
  // Frames that the file has are looked at again only for their pictures.
  std::uint32_t index = 0;
  if (writer_ && job_.images.empty()) {
    const std::uint64_t whole = writer_->passes() / job_.settings.passes;
    index = static_cast<std::uint32_t>(std::min<std::uint64_t>(whole, range_.count - 1));
  }
  const core::Clock::time_point started = core::Clock::now();
  const double time_limit = job_.settings.time_limit;
  for (; index < range_.count; ++index) {
    if (index > 0) {
      shot.reset();  // two scenes at once may be too many
      shot = std::make_unique<const Shot>(job_, range_.first + index);
    }
    job_.settings.time_limit = time_limit - core::seconds_since(started);
    shoot(index, *shot);
    if (result_.render.interrupted || result_.render.out_of_time) break;
  }
  if (writer_ && result_.render.interrupted) {
    writer_.reset();  // cuts off what is not whole
    std::error_code ignored;
    if (result_.render.passes > 0) result_.bytes = fs::file_size(job_.output, ignored);
  } else if (writer_) {
    result_.bytes = writer_->bytes_written();
  }
  return std::move(result_);
}

}  // namespace

JobResult run_job(const Job& job) {
  check_names(job);
  if (job.settings.frames && is_numbered(job.output)) return run_apart(job);
  check_all_files(job, {}, job.images);  // what can be said before anything is loaded
  return Run(with_frame_channel(job)).run();
}

double JobResult::rays_per_second() const {
  return static_cast<double>(render.rays) / std::max(1e-9, render.seconds);
}

void throw_if_stopped(const Job& job, const JobResult& result) {
  if (!result.render.interrupted) return;
  const std::uint64_t pass = result.render.passes;
  if (pass == 0) {
    throw Error(ErrorCode::interrupted,
                fmt::format("interrupted in pass 1 of {}, which was not whole within a second: "
                            "nothing is written",
                            job.settings.total_passes()));
  }
  const std::string kept = result.bytes ? job.output + " keeps" : "the pictures keep";
  throw Error(ErrorCode::interrupted,
              fmt::format("interrupted after pass {} of {}: {} all {} paths of them{}", pass,
                          job.settings.total_passes(), kept, result.render.paths,
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
