#include "export/denoisers.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "core/interrupt.h"
#include "core/text.h"
#include "export/denoiser_input.h"
#include "export/output_folder.h"
#include "film/picture_names.h"

namespace psf::exports {
namespace {

struct CameraInput {
  std::unique_ptr<DenoiserInput> input;
  std::vector<std::uint32_t> paths;  // of each pixel, in the picture
};

std::unique_ptr<DenoiserInput> make_input(Denoiser denoiser, const DenoiserSource& source) {
  switch (denoiser) {
    case Denoiser::oidn:
      return make_oidn_input(source);
    case Denoiser::nfor:
      return make_nfor_input(source);
    case Denoiser::bcd:
      return make_bcd_input(source);
  }
  return nullptr;
}

// The folder of each camera in the folder, with its slash; "" where there is but one.
std::vector<std::string> folders_of(const run::Dump& dump) {
  std::vector<std::string> cameras, folders;
  for (const formats::CameraInfo& camera : dump.metadata().cameras) cameras.push_back(camera.name);
  const film::PictureNames names({"x"}, cameras);  // x.left
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    folders.push_back(cameras.size() > 1 ? names.path(0, k, 0).substr(2) + "/" : "");
  }
  return folders;
}

film::Attributes attributes_of(const run::Dump& dump, const std::string& version) {
  const formats::Metadata& m = dump.metadata();
  film::Attributes attributes =
      film::attributes_of(version, {m.scene, m.scene_hash, m.integrator, m.sampler, m.seed});
  const std::string file = std::filesystem::path(dump.reader().path()).filename().string();
  attributes.emplace_back("psf:dump", file);
  attributes.emplace_back("psf:dump-uuid", dump.reader().uuid());
  return attributes;
}

std::vector<CameraInput> sum_up(Denoiser denoiser, const run::Dump& dump,
                                const run::PassSelection& passes, DenoiserResult& result,
                                const ExportProgress& progress) {
  std::vector<CameraInput> cameras;
  for (const filter::CameraView& view : dump.cameras()) {
    DenoiserSource source;
    source.width = view.width;
    source.height = view.height;
    source.albedo = dump.find("reflectance").has_value();
    source.normal = dump.find("normal").has_value();
    source.depth = dump.find("distance").has_value();
    cameras.push_back({make_input(denoiser, source), std::vector<std::uint32_t>(source.pixels())});
  }
  result.paths = run::for_each_unfiltered_path(
      dump, passes,
      [&cameras](std::span<const run::UnfilteredPath> paths) {
        for (const run::UnfilteredPath& path : paths) {
          CameraInput& camera = cameras[path.camera];
          camera.paths[path.pixel] += path.in_picture ? 1 : 0;
          camera.input->add(path);
        }
      },
      [&](std::uint64_t done, std::uint64_t total) {
        core::throw_if_interrupted("nothing was exported");
        if (progress) progress(done, total);
      });
  for (const CameraInput& camera : cameras) {
    for (const std::uint32_t count : camera.paths) {
      result.without_path += count == 0 ? 1 : 0;
      result.with_one_path += count == 1 ? 1 : 0;
    }
  }
  return cameras;
}

std::vector<std::string> notes_of(Denoiser denoiser, const run::Dump& dump,
                                  const DenoiserResult& result) {
  std::vector<std::string> notes;
  const std::string& path = dump.reader().path();
  struct Feature {
    const char *channel, *name;
    bool of_oidn;
  };
  for (const Feature& feature :
       {Feature{"reflectance", "albedo", true}, Feature{"normal", "normal", true},
        Feature{"distance", "depth", false}}) {
    const bool used = denoiser == Denoiser::nfor || (denoiser == Denoiser::oidn && feature.of_oidn);
    if (!used || dump.find(feature.channel)) continue;
    notes.push_back(fmt::format("{}: has no channel {}, so {} is left out", path, feature.channel,
                                feature.name));
  }
  if (result.without_path > 0) {
    notes.push_back(fmt::format(
        "{}: no path in the picture of {}; {}", path,
        core::counted(result.without_path, "pixel", "pixels"),
        denoiser == Denoiser::oidn ? "they have the colour around them" : "they are black"));
  }
  if (result.with_one_path > 0 && denoiser != Denoiser::oidn) {
    notes.push_back(
        fmt::format("{}: one path in the picture of {}: their variance is not known, "
                    "and written as 0",
                    path, core::counted(result.with_one_path, "pixel", "pixels")));
  }
  return notes;
}

}  // namespace

DenoiserResult export_for(Denoiser denoiser, const run::Dump& dump,
                          const run::PassSelection& passes, const std::string& folder,
                          const std::string& version, const ExportProgress& progress) {
  DenoiserResult result;
  OutputFolder output(folder, "the pictures");
  std::vector<CameraInput> cameras = sum_up(denoiser, dump, passes, result, progress);
  const std::vector<std::string> folders = folders_of(dump);
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    core::throw_if_interrupted("nothing was exported");
    if (!folders[k].empty()) output.make_folder(folders[k].substr(0, folders[k].size() - 1));
    film::Attributes attributes = attributes_of(dump, version);
    film::add_picture(attributes, dump.metadata().cameras[k].name, passes.first,
                      passes.first + result.paths.passes);
    PictureFolder pictures(output, folders[k], std::move(attributes), result.files, result.bytes);
    cameras[k].input->write(pictures);
    cameras[k].input.reset();  // its memory is needed no more
  }
  output.commit();
  result.notes = notes_of(denoiser, dump, result);
  return result;
}

}  // namespace psf::exports
