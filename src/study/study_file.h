// The common parts of the files of studies: descriptions of dump, reference and metrics, and numbers
// in JSON.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "filter/parameters/parameters.h"
#include "formats/layout/metadata.h"
#include "metrics/metrics.h"
#include "run/dump.h"
#include "run/noise_share.h"
#include "run/passes.h"

namespace psf::study {

using Json = nlohmann::ordered_json;

inline constexpr int kStudyFormat = 1;  // raised where readers have to know of a change

// `value`, or null where it is not finite.
[[nodiscard]] Json number_or_null(double value);

// Describes the dump, the passes, the camera and, where one is chosen, the vertex of a study.
[[nodiscard]] Json describe_input(const run::Dump& dump, const run::PassSelection& passes,
                                  std::size_t camera);
// Describes a reference. `file`: the name that the user gave. A checksum tells pictures apart.
[[nodiscard]] Json describe_reference(const std::string& file, std::span<const Rgb> picture);
// Describes each metric by its name, its settings, and whether lower is better.
[[nodiscard]] Json describe_metrics(std::span<const metrics::Metric> metrics,
                                    const metrics::MetricOptions& options);
// The values of the metrics `asked`, by name.
[[nodiscard]] Json to_json(const metrics::Metrics& metrics, std::span<const metrics::Metric> asked);
// Each parameter as text by the name of its option, as psf filter takes it.
[[nodiscard]] Json to_json(const filter::Parameters& parameters);

// The noise of the picture without filter, an entry a camera; the share is null where there is
// none.
[[nodiscard]] Json describe_noise(std::span<const run::NoiseShare> noise,
                                  std::span<const formats::CameraInfo> cameras);

// A value as a cell of a CSV table: quoted where it must be, empty for null.
[[nodiscard]] std::string csv_cell(const Json& value);
// Flat objects with the same names as a CSV table: a line of the names, and one for each.
[[nodiscard]] std::string csv_table(const Json& rows);

// A study that is there already stays: throws Error{usage} where the file exists.
void check_none_there(const std::string& path);

// Reads the file of a study. `kind`: for example "sweep"; `remedy`: the end of error messages.
// Throws Error{bad_input} where the file is no JSON or has another kind or format, Error{io} where
// it cannot be read.
[[nodiscard]] Json read_study_file(const std::string& path, const std::string& kind,
                                   const std::string& remedy);

}  // namespace psf::study
