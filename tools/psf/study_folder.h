// What psf sweep and psf converge have in common: a reference to measure against and a folder that
// takes the results.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"
#include "filter/parameters.h"
#include "study/dump.h"
#include "study/metrics/metrics.h"
#include "study/passes.h"

namespace psf::tools {

struct StudyOptions {
  std::string reference, reference_layer, folder, passes, camera;
  std::string metric = "relMSE";  // orders what is printed
  study::MetricOptions metrics;
  bool pictures = false;
  std::optional<std::uint64_t> max_memory;  // bytes
};

// `required`: whether --reference must be given.
void add_study_options(CLI::App& command, StudyOptions& options, bool required);

class StudyFolder {
 public:
  // Reads the reference; what is to be said of it is added to `notes`. Throws Error{usage} for a
  // camera that is not there or not named though there are several, Error{bad_input} where the
  // reference has another size.
  StudyFolder(const StudyOptions& options, const study::Dump& dump,
              std::vector<std::string>& notes);

  // The names, in the folder, are apart from the inputs and from --json (check_files()); then it is
  // made where it is missing.
  void make(std::vector<std::string> inputs, const std::vector<std::string>& names,
            const std::string& json) const;

  [[nodiscard]] const std::string& path() const { return options_.folder; }
  [[nodiscard]] const study::PassSelection& passes() const { return passes_; }
  [[nodiscard]] std::size_t camera() const { return camera_; }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] const std::vector<Rgb>& reference_picture() const { return reference_; }
  [[nodiscard]] const study::MetricOptions& metric_options() const { return options_.metrics; }
  [[nodiscard]] study::Metric metric() const { return metric_; }

  // "reference.exr", unless the reference is that file; with --pictures one of the names.
  void write_reference() const;
  // A picture of the reference's size as EXR; with parameters they are its attributes.
  void write(const std::string& name, std::span<const Rgb> picture,
             const std::optional<filter::Parameters>& parameters) const;

 private:
  [[nodiscard]] std::string file(const std::string& name) const;

  StudyOptions options_;
  study::PassSelection passes_;
  study::Metric metric_;
  std::size_t camera_ = 0, width_ = 0, height_ = 0;
  std::vector<Rgb> reference_;
};

// The number of the camera of this name, the only one where it is empty.
[[nodiscard]] std::size_t find_camera(const study::Dump& dump, const std::string& name);

}  // namespace psf::tools
