#include "study/study_file.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "core/error.h"
#include "core/json_text.h"
#include "filter/parameters/text.h"
#include "formats/layout/crc.h"

namespace psf::study {

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json describe_input(const run::Dump& dump, const run::PassSelection& passes, std::size_t camera) {
  const formats::Metadata& metadata = dump.metadata();
  const std::size_t last = run::last_pass(dump, passes);
  const filter::CameraView& view = dump.cameras()[camera];
  Json json = {{"file", dump.reader().path()},
               {"uuid", dump.reader().uuid()},
               {"scene", metadata.scene},
               {"integrator", metadata.integrator},
               {"sampler", metadata.sampler},
               {"seed", metadata.seed},
               {"first_pass", passes.first},
               {"passes", last - passes.first},
               {"records", dump.pass_bounds()[last] - dump.pass_bounds()[passes.first]},
               {"width", view.width},
               {"height", view.height},
               {"camera", metadata.cameras[camera].name}};
  if (dump.vertex_rule()) json["vertex"] = to_text(*dump.vertex_rule());
  return json;
}

Json describe_reference(const std::string& file, std::span<const Rgb> picture) {
  return {{"file", file},
          {"crc32", fmt::format("{:08x}", formats::crc32(std::as_bytes(picture)))},
          {"picture", nullptr}};
}

Json describe_metrics(std::span<const metrics::Metric> metrics,
                      const metrics::MetricOptions& options) {
  Json list = Json::array();
  for (const metrics::Metric metric : metrics) {
    Json one = {{"name", name(metric)}, {"lower_is_better", metrics::lower_is_better(metric)}};
    const std::string depends_on = settings(metric, options);
    if (!depends_on.empty()) one["settings"] = depends_on;
    list.push_back(one);
  }
  return list;
}

Json to_json(const metrics::Metrics& metrics, std::span<const metrics::Metric> asked) {
  Json json = Json::object();
  for (const metrics::Metric metric : asked) json[name(metric)] = number_or_null(metrics[metric]);
  return json;
}

Json to_json(const filter::Parameters& parameters) {
  Json json = Json::object();
  for (const auto& [option, value] : filter::describe(parameters)) json[option] = value;
  return json;
}

Json describe_noise(std::span<const run::NoiseShare> noise,
                    std::span<const formats::CameraInfo> cameras) {
  Json list = Json::array();
  for (std::size_t k = 0; k < noise.size(); ++k) {
    list.push_back({{"camera", cameras[k].name},
                    {"unfiltered_share", noise[k].share()},
                    {"variance", noise[k].variance()},
                    {"unfiltered", noise[k].unfiltered},
                    {"contribution", noise[k].contribution},
                    {"covariance", noise[k].covariance},
                    {"pixels", noise[k].pixels}});
  }
  return list;
}

std::string csv_cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return core::json_text(value);
  std::string text = value.get<std::string>();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_table(const Json& rows) {
  std::string text;
  const auto line = [&text](const Json& row, bool header) {
    const char* separator = "";
    for (const auto& [name, value] : row.items()) {
      text += separator + (header ? name : csv_cell(value));
      separator = ",";
    }
    text += "\n";
  };
  line(rows[0], true);
  for (const Json& row : rows) line(row, false);
  return text;
}

void check_none_there(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return;
  throw Error(ErrorCode::usage, path + ": is there already; give another folder");
}

Json read_study_file(const std::string& path, const std::string& kind, const std::string& remedy) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::io, path + ": cannot be read");
  Json json = Json::parse(file, nullptr, false);
  const auto refuse = [&](const std::string& why) {
    return Error(ErrorCode::bad_input, fmt::format("{}: {}; {}", path, why, remedy));
  };
  if (json.is_discarded() || !json.is_object()) throw refuse("is no JSON of ours");
  if (json.value("kind", "") != kind) throw refuse("is no " + kind);
  if (json.value("format", 0) != kStudyFormat) throw refuse("is of another version of psf");
  return json;
}

}  // namespace psf::study
