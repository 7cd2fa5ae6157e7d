// The files ablate.json and ablate.csv of an ablation.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/ablate.h"
#include "study/study_file.h"

namespace psf::study {

struct AblateReport {
  std::string version;
  Json input;                                 // describe_input()
  Json reference = nullptr;                   // describe_reference(), or null
  Json metrics = Json::array();               // describe_metrics(), none without a reference
  std::span<const metrics::Metric> measured;  // the metrics of the rows
  std::vector<AblationRow> rows;
  bool with_pictures = false;  // pictures were written, with names by ablation_picture()
};

// The file name of a row's picture, "0001.exr" of the first.
[[nodiscard]] std::string ablation_picture(std::size_t row);

[[nodiscard]] Json to_json(const AblateReport& report);
// A flat object for each row: id, part, label, passes, and values by name.
[[nodiscard]] Json to_rows(const AblateReport& report);
// The same as a table, one line each.
[[nodiscard]] std::string to_csv(const AblateReport& report);

}  // namespace psf::study
