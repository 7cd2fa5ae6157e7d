// What the files of sweeps and convergence studies have in common: which dump, which reference,
// which metrics, and numbers as JSON has them.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "filter/parameters.h"
#include "study/dump.h"
#include "study/metrics/metrics.h"
#include "study/passes.h"

namespace psf::study {

using Json = nlohmann::ordered_json;

inline constexpr int kStudyFormat = 1;  // of the files; a change that readers must know raises it

// null for what is no finite number.
[[nodiscard]] Json number_or_null(double value);

// The dump, the passes and the camera that a study looks at.
[[nodiscard]] Json describe_input(const Dump& dump, const PassSelection& passes,
                                  std::size_t camera);
// `file`: as the user gave it; the checksum tells pictures apart.
[[nodiscard]] Json describe_reference(const std::string& file, std::span<const Rgb> picture);
// An entry a metric: its name, what it depends on, whether lower is better.
[[nodiscard]] Json describe_metrics(std::span<const Metric> metrics, const MetricOptions& options);
// Values by name.
[[nodiscard]] Json to_json(const Metrics& metrics, std::span<const Metric> asked);
// Text by the name of its option, as psf filter takes it.
[[nodiscard]] Json to_json(const filter::Parameters& parameters);

// A value as a cell of a table: quoted where it must be, empty for null.
[[nodiscard]] std::string csv_cell(const Json& value);

// Throws Error{bad_input} where the file is no JSON or of another kind or format, Error{io} where
// it cannot be read. `kind`: "sweep"; `remedy`: ends the message.
[[nodiscard]] Json read_study_file(const std::string& path, const std::string& kind,
                                   const std::string& remedy);

}  // namespace psf::study
