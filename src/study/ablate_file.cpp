#include "study/ablate_file.h"

#include <fmt/format.h>

namespace psf::study {
namespace {

std::string ablation_id(std::size_t row) {
  return fmt::format("{:04}", row + 1);
}

Json ablation_row(const AblateReport& report, std::size_t k) {
  const AblationRow& row = report.rows[k];
  const bool is_filtered = row.parameters.has_value();
  const auto if_filtered = [is_filtered](const Json& value) {
    return is_filtered ? value : Json(nullptr);
  };
  return {{"id", ablation_id(k)},
          {"part", name(row.part)},
          {"label", row.label},
          {"parameters", is_filtered ? to_json(*row.parameters) : Json(nullptr)},
          {"first_pass", row.first},
          {"passes", row.last - row.first},
          {"metrics", to_json(row.metrics, report.measured)},
          {"mean", number_or_null(row.mean)},
          {"change", number_or_null(row.change)},
          {"neighbors", if_filtered(row.neighbors)},
          {"orphans", if_filtered(row.orphans)},
          {"left_out", if_filtered(row.left_out)},
          {"seconds", if_filtered(row.seconds)},
          {"picture", report.with_pictures ? Json(ablation_picture(k)) : Json(nullptr)}};
}

}  // namespace

std::string ablation_picture(std::size_t row) {
  return ablation_id(row) + ".exr";
}

Json to_json(const AblateReport& report) {
  Json rows = Json::array();
  for (std::size_t k = 0; k < report.rows.size(); ++k) rows.push_back(ablation_row(report, k));
  return {{"kind", "ablate"},      {"format", kStudyFormat},        {"version", report.version},
          {"input", report.input}, {"reference", report.reference}, {"metrics", report.metrics},
          {"rows", rows}};
}

Json to_rows(const AblateReport& report) {
  Json names = Json::object();  // of all parameters
  for (const AblationRow& row : report.rows) {
    if (row.parameters) names = to_json(*row.parameters);
  }
  Json rows = Json::array();
  for (std::size_t k = 0; k < report.rows.size(); ++k) {
    const Json row = ablation_row(report, k);
    Json flat = Json::object();
    for (const auto& [key, value] : row.items()) {
      if (key == "metrics") {
        flat.update(value);
      } else if (key == "parameters") {
        for (const auto& name : names.items()) {
          flat[name.key()] = value.is_null() ? Json(nullptr) : value[name.key()];
        }
      } else {
        flat[key] = value;
      }
    }
    rows.push_back(flat);
  }
  return rows;
}

std::string to_csv(const AblateReport& report) {
  return csv_table(to_rows(report));
}

}  // namespace psf::study
