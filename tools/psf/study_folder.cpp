#include "study_folder.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "cli.h"
#include "core/apart.h"
#include "core/error.h"
#include "core/output_file.h"
#include "film/image.h"
#include "film/picture.h"
#include "filter/parameters/text.h"
#include "metric_option.h"
#include "notes.h"
#include "pass_range.h"
#include "version.h"

namespace psf::tools {

bool lies_in(const std::string& file, const std::string& folder) {
  const std::filesystem::path without_slash = (std::filesystem::path(folder) / "").parent_path();
  return !folder.empty() && std::filesystem::path(file).parent_path() == without_slash;
}

void add_study_options(CLI::App& command, StudyOptions& options, bool required) {
  command.add_option("--reference", options.reference, "what is right: an EXR of the same size")
      ->required(required)
      ->type_name("FILE.exr");
  command
      .add_option("--reference-layer,--layer", options.reference_layer,
                  "layer of the reference; the colours at its root, or the only ones there are, "
                  "unless given")
      ->type_name("NAME");
  command.add_option("-o,--output", options.folder, "folder for the results; made where missing")
      ->required()
      ->type_name("DIR");
  command.add_option("--passes", options.passes, kPassesHelp)->type_name("FIRST:LAST");
  command.add_option("--camera", options.camera, "which camera, where the dump has several")
      ->type_name("NAME");
  add_metric(command, options.metric, "orders what is printed");
  command
      .add_option("--epsilon", options.metrics.epsilon,
                  "of the relative metrics: guards dark places")
      ->capture_default_str();
  command.add_flag("--pictures", options.pictures, "also write every picture as EXR");
  command
      .add_option("--max-memory", options.max_memory,
                  "what it may take, 500M or 4G: shares less, or refuses (default no limit)")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
}

std::size_t find_camera(const run::Dump& dump, const std::string& name) {
  const auto& cameras = dump.metadata().cameras;
  if (name.empty() && cameras.size() == 1) return 0;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (!name.empty() && cameras[k].name == name) return k;
    names.push_back(cameras[k].name);
  }
  throw Error(ErrorCode::usage,
              fmt::format("{}: {}; give --camera one of: {}", dump.reader().path(),
                          name.empty() ? "has several cameras" : "has no camera '" + name + "'",
                          fmt::join(names, ", ")));
}

film::Picture read_reference(const std::string& path, const std::string& layer,
                             const run::Dump& dump, std::size_t camera,
                             std::vector<std::string>& notes) {
  film::Picture image = film::read_picture(path, {layer, "", "`reference-layer`"});
  const filter::CameraView& view = dump.cameras()[camera];
  if (image.width != view.width || image.height != view.height) {
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: is {}x{}, the camera's picture in {} {}x{}; give a reference of "
                            "its size",
                            path, image.width, image.height, dump.reader().path(), view.width,
                            view.height));
  }
  film::Picture picture;
  picture.width = image.width;
  picture.height = image.height;
  picture.left = image.left;
  picture.top = image.top;
  picture.path = dump.reader().path();
  const std::string note = film::check_comparable(image, picture);
  notes.insert(notes.end(), image.notes.begin(), image.notes.end());
  if (!note.empty()) notes.push_back(note);
  return image;
}

void write_study_picture(const std::string& path, std::size_t width, std::size_t height,
                         std::span<const Rgb> picture,
                         const std::optional<filter::Parameters>& parameters,
                         const std::optional<run::VertexRule>& vertex) {
  film::Image image;
  image.width = width;
  image.height = height;
  std::vector<float> values;
  values.reserve(3 * picture.size());
  for (const Rgb& value : picture) values.insert(values.end(), {value.x, value.y, value.z});
  image.add("", "RGB", values);
  image.attributes.emplace_back("psf:version", kVersion);
  if (parameters) {
    if (vertex) image.attributes.emplace_back("psf:vertex", to_text(*vertex));
    for (const auto& [option, value] : filter::describe(*parameters)) {
      image.attributes.emplace_back("psf:" + option, value);
    }
  }
  film::write_exr(path, image);
}

StudyFolder::StudyFolder(const StudyOptions& options, const run::Dump& dump,
                         std::vector<std::string>& notes)
    : options_(options),
      passes_(parse_passes(options.passes)),
      metric_(metrics::parse_metric(options.metric)),
      camera_(find_camera(dump, options.camera)),
      vertex_(dump.vertex_rule()) {
  options_.metrics.validate();
  film::Picture image =
      read_reference(options_.reference, options_.reference_layer, dump, camera_, notes);
  reference_ = std::move(image.colors);
  width_ = image.width;
  height_ = image.height;
}

std::string StudyFolder::file(const std::string& name) const {
  return (std::filesystem::path(options_.folder) / name).string();
}

core::NewFolder StudyFolder::make(std::vector<std::string> inputs,
                                  const std::vector<std::string>& names,
                                  const std::string& json) const {
  std::vector<std::string> outputs = {json};
  for (const std::string& name : names) outputs.push_back(file(name));
  std::error_code error;
  const bool is_there = options_.pictures && std::filesystem::equivalent(
                                                 options_.reference, file("reference.exr"), error);
  if (options_.pictures && !is_there) outputs.push_back(file("reference.exr"));
  inputs.push_back(options_.reference);
  core::check_apart(inputs, outputs);
  // Nothing is made where --json cannot be; it may lie in the folder itself.
  const bool json_is_inside = lies_in(json, options_.folder);
  if (!json_is_inside) check_files({}, {json});
  core::NewFolder made(options_.folder);
  if (json_is_inside) check_files({}, {json});
  return made;
}

std::optional<std::string> StudyFolder::write_reference() const {
  std::error_code error;
  if (std::filesystem::equivalent(options_.reference, file("reference.exr"), error)) {
    return std::nullopt;
  }
  return write("reference.exr", reference_, {});
}

std::string StudyFolder::write(const std::string& name, std::span<const Rgb> picture,
                               const std::optional<filter::Parameters>& parameters) const {
  std::string path = file(name);
  write_study_picture(path, width_, height_, picture, parameters, vertex_);
  return path;
}

}  // namespace psf::tools
