// The common parts of psf sweep, converge and ablate: a reference to measure against, and a folder
// for the results.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"
#include "film/picture.h"
#include "filter/parameters/parameters.h"
#include "metrics/metrics.h"
#include "run/dump.h"
#include "run/passes.h"

namespace psf::tools {

struct StudyOptions {
  std::string reference, reference_layer, folder, passes, camera;
  std::string metric = "relMSE";  // printed results are ordered by it
  metrics::MetricOptions metrics;
  bool pictures = false;
  std::optional<std::uint64_t> max_memory;  // bytes
};

// `required`: whether --reference must be given.
void add_study_options(CLI::App& command, StudyOptions& options, bool required);

class StudyFolder {
 public:
  // Reads the reference, and adds remarks about it to `notes`. Throws Error{usage} where the camera
  // does not exist, or is not named though there are several, Error{bad_input} where the reference
  // has another size.
  StudyFolder(const StudyOptions& options, const run::Dump& dump, std::vector<std::string>& notes);

  // Checks that the files `names` in the folder are none of the inputs nor the file of --json
  // (check_files()), and then makes the folder where it is missing.
  void make(std::vector<std::string> inputs, const std::vector<std::string>& names,
            const std::string& json) const;

  [[nodiscard]] const std::string& path() const { return options_.folder; }
  [[nodiscard]] const run::PassSelection& passes() const { return passes_; }
  [[nodiscard]] std::size_t camera() const { return camera_; }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] const std::vector<Rgb>& reference_picture() const { return reference_; }
  [[nodiscard]] const metrics::MetricOptions& metric_options() const { return options_.metrics; }
  [[nodiscard]] metrics::Metric metric() const { return metric_; }

  // Writes the reference as "reference.exr", unless it was read from that file. With --pictures
  // this is one of the names.
  void write_reference() const;
  // Writes a picture of the reference's size as EXR, with `parameters`, if given, as its
  // attributes.
  void write(const std::string& name, std::span<const Rgb> picture,
             const std::optional<filter::Parameters>& parameters) const;

 private:
  [[nodiscard]] std::string file(const std::string& name) const;

  StudyOptions options_;
  run::PassSelection passes_;
  metrics::Metric metric_;
  std::size_t camera_ = 0, width_ = 0, height_ = 0;
  std::optional<run::VertexRule> vertex_;
  std::vector<Rgb> reference_;
};

// The number of the camera called `name`, or of the only camera where `name` is empty.
[[nodiscard]] std::size_t find_camera(const run::Dump& dump, const std::string& name);

// Reads a reference for the pictures of a camera, and adds remarks about it to `notes`. Throws
// Error{bad_input} where it has another size or shows another place.
[[nodiscard]] film::Picture read_reference(const std::string& path, const std::string& layer,
                                           const run::Dump& dump, std::size_t camera,
                                           std::vector<std::string>& notes);

// Writes a picture as EXR, with `parameters`, if given, and the choice of the vertex of its dump as
// its attributes.
void write_study_picture(const std::string& path, std::size_t width, std::size_t height,
                         std::span<const Rgb> picture,
                         const std::optional<filter::Parameters>& parameters,
                         const std::optional<run::VertexRule>& vertex);

}  // namespace psf::tools
