// Settings of a render: their limits, and what the file says of them.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "formats/layout/layout.h"
#include "formats/layout/metadata.h"
#include "render/camera/camera.h"
#include "render/loop/photon_table.h"
#include "render/loop/recorder.h"
#include "render/loop/render.h"
#include "render/loop/vertex_table.h"

namespace psf::render {

void RenderSettings::validate(const Scene& scene) const {
  if (passes == 0) throw Error(ErrorCode::usage, "passes: at least 1 is needed");
  if (shade_rate == 0 || shade_rate > kMostShadeRate) {
    throw Error(ErrorCode::usage, fmt::format("shade rate: 1 to 1/{} is possible", kMostShadeRate));
  }
  if (scene.cameras.empty()) {
    throw Error(ErrorCode::bad_input, scene.name + ": there is no camera, give one");
  }
  double pixels = 0;
  const auto chosen = chosen_cameras(scene, *this);
  for (const std::size_t k : chosen) {
    pixels += static_cast<double>(scene.cameras[k].width) * scene.cameras[k].height;
  }
  const FrameRange range = frame_range();
  if (range.count == 0) throw Error(ErrorCode::usage, "frames: at least 1 is needed");
  // Points of the sequences are numbered from frame 0 on.
  const double paths = pixels * static_cast<double>(passes) *
                       static_cast<double>(range.first + std::uint64_t{range.count});
  const bool vpls = integrator.name == "vpl",
             of_pixels = vpls && integrator.vpl_set == VplSet::pixel;
  std::uint32_t of_a_pass = integrator.photons;  // those of the table
  if (integrator.name == "photon") of_a_pass = std::max(of_a_pass, integrator.photon_paths);
  if (vpls) of_a_pass = std::max(of_a_pass, integrator.vpl_paths);
  const double light_paths = static_cast<double>(passes) * of_a_pass;
  if (light_paths >= 0x1p40 ||
      (of_pixels && paths * integrator.split * integrator.vpl_paths >= 0x1p48)) {
    throw Error(ErrorCode::limit,
                "more than 2^40 light paths, or 2^48 drawn for the pixels; lower the passes or the "
                "light paths");
  }
  if (chosen.size() > 65535 || pixels >= 0x1p32 || paths >= 0x1p40 ||
      paths * integrator.split >= 0x1p48) {
    throw Error(ErrorCode::limit,
                "more than 65535 cameras, 2^32 paths a pass, 2^40 paths or 2^48 continuations; "
                "lower the size, the passes or the split");
  }
}

std::vector<std::size_t> chosen_cameras(const Scene& scene, const RenderSettings& settings) {
  if (!settings.cameras.empty()) return settings.cameras;
  std::vector<std::size_t> all(scene.cameras.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

namespace {

formats::FrameInfo frame_info(const Scene& scene, const RenderSettings& settings,
                              std::span<const std::vector<Camera>> frames) {
  const FrameRange range = settings.frame_range();
  formats::FrameInfo info{range.first, range.count, settings.passes, {}};
  for (const std::vector<Camera>& cameras : frames) {
    std::vector<formats::CameraInfo>& of_frame = info.cameras.emplace_back();
    for (const std::size_t k : chosen_cameras(scene, settings)) {
      of_frame.push_back(CameraRays(cameras[k]).info(scene.space));
    }
  }
  const auto same = [&](const auto& cameras) { return cameras == info.cameras[0]; };
  if (std::all_of(info.cameras.begin(), info.cameras.end(), same)) info.cameras.clear();
  return info;
}

}  // namespace

formats::Head make_head(const Scene& scene, const Integrator& integrator,
                        const RenderSettings& settings,
                        std::span<const std::vector<Camera>> frames) {
  formats::Metadata metadata;
  metadata.producer = settings.producer;
  metadata.scene = scene.name;
  metadata.scene_hash = scene.hash;
  metadata.integrator = settings.integrator.name;
  metadata.sampler = to_string(settings.sampler.kind);
  metadata.enumeration = to_string(settings.sampler.enumeration);
  metadata.seed = settings.sampler.seed;
  metadata.block_base = block_base(settings.sampler.kind);
  metadata.split = settings.integrator.split;
  metadata.shade_rate = settings.shade_rate;
  metadata.vertex_roughness = double{settings.integrator.vertex_roughness};
  metadata.vertex_rule = fmt::format(
      "the first vertex of the camera path with a perceptual roughness of at least {} (diffuse: "
      "1); "
      "paths that meet none have no vertex",
      settings.integrator.vertex_roughness);
  metadata.units = "scene";
  for (const std::size_t k : chosen_cameras(scene, settings)) {
    metadata.cameras.push_back(CameraRays(scene.cameras[k]).info(scene.space));
  }
  if (settings.frames) metadata.frames = frame_info(scene, settings, frames);
  metadata.lights = integrator.light_names();
  metadata.visibility_rule = integrator.visibility_rule();
  for (const Material& material : scene.materials) metadata.materials.push_back(material.name);

  formats::Head head;
  head.channels = record_channels(settings.channels, integrator.layers(), integrator.has_volumes());
  if (settings.integrator.vertices > 0) {
    head.tables.push_back(table_of("vertices", vertex_columns()));
  }
  if (settings.integrator.photons > 0) {
    head.tables.push_back(table_of("photons", photon_columns()));
  }
  head.metadata = formats::to_json(metadata);
  // Names are a help and no reason to refuse a scene of very many materials.
  while (head.metadata.size() > formats::kMaxMetadata && !metadata.materials.empty()) {
    metadata.materials.resize(metadata.materials.size() / 2);
    head.metadata = formats::to_json(metadata);
  }
  if (head.metadata.size() > formats::kMaxMetadata && frames.size() > 1) {
    throw Error(
        ErrorCode::limit,
        fmt::format("the cameras of {} frames do not fit the metadata of a file; render fewer "
                    "frames, or a file a frame, by #### in its name",
                    frames.size()));
  }
  return head;
}

std::string to_string(SamplerKind kind) {
  switch (kind) {
    case SamplerKind::sobol:
      return "sobol";
    case SamplerKind::halton:
      return "halton";
    case SamplerKind::independent:
      return "independent";
  }
  return "?";
}

std::string to_string(Enumeration enumeration) {
  return enumeration == Enumeration::global ? "global" : "pixel";
}

}  // namespace psf::render
