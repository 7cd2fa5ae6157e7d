#include "study/sweep_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/error.h"
#include "core/json_text.h"
#include "core/output_file.h"

namespace psf::study {
namespace {

std::string json_path(const std::string& folder) {
  return (std::filesystem::path(folder) / "sweep.json").string();
}

Json picture_or_null(const std::string& picture) {
  return picture.empty() ? Json(nullptr) : Json(picture);
}

}  // namespace

SweepFile::SweepFile(std::string folder, About about, bool resume) : folder_(std::move(folder)) {
  json_ = {{"kind", "sweep"},       {"format", kStudyFormat},       {"version", about.version},
           {"input", about.input},  {"reference", about.reference}, {"metrics", about.metrics},
           {"unfiltered", nullptr}, {"rows", Json::array()}};
  const std::string path = json_path(folder_);
  if (!std::filesystem::exists(path)) return;
  if (!resume) {
    throw Error(ErrorCode::usage,
                path + ": is there already; give `resume` to add to it, or another folder");
  }
  Json before = read_study_file(path, "sweep", "give another folder");
  const auto same = [&](const char* what, const Json& old, const Json& now) {
    if (old == now) return;
    throw Error(ErrorCode::bad_input,
                fmt::format("{}: is of another {}; give another folder", path, what));
  };
  const auto part = [](Json json, const char* without) {
    json.erase(without);
    return json;
  };
  same("dump or other passes", part(before["input"], "file"), part(about.input, "file"));
  same("reference", before["reference"]["crc32"], about.reference["crc32"]);
  same("choice of metrics", before["metrics"], about.metrics);
  json_ = std::move(before);
}

bool SweepFile::has(const filter::Parameters& parameters) const {
  const Json asked = to_json(parameters);
  const Json& rows = json_["rows"];
  return std::any_of(rows.begin(), rows.end(),
                     [&](const Json& row) { return row["parameters"] == asked; });
}

std::string SweepFile::next_id() const {
  return id(json_["rows"].size());
}

std::string SweepFile::id(std::size_t rows) {
  return fmt::format("{:04}", rows + 1);
}

void SweepFile::add(const SweepRow& row, std::span<const metrics::Metric> metrics,
                    const std::string& picture) {
  json_["rows"].push_back({{"id", next_id()},
                           {"parameters", to_json(row.parameters)},
                           {"metrics", to_json(row.metrics, metrics)},
                           {"neighbors", row.neighbors},
                           {"radius",
                            {{"first_px", number_or_null(row.first_radius)},
                             {"last_px", number_or_null(row.last_radius)}}},
                           {"orphans", row.orphans},
                           {"left_out", row.left_out},
                           {"seconds", row.seconds},
                           {"shared", row.shared},
                           {"picture", picture_or_null(picture)}});
}

void SweepFile::set_unfiltered(const metrics::Metrics& values,
                               std::span<const metrics::Metric> metrics,
                               const std::string& picture) {
  json_["unfiltered"] = {{"metrics", to_json(values, metrics)},
                         {"picture", picture_or_null(picture)}};
}

void SweepFile::set_reference_picture(const std::string& picture) {
  json_["reference"]["picture"] = picture;
}

void SweepFile::write() const {
  core::write_text_file((std::filesystem::path(folder_) / "sweep.csv").string(), csv());
  core::write_json_file(json_path(folder_), json_, 1);
}

std::string SweepFile::csv() const {
  std::string text;
  const auto line = [&text](const Json& row, bool names) {
    std::string cells;
    const auto add = [&cells](const Json& value) {
      if (!cells.empty()) cells += ',';
      cells += csv_cell(value);
    };
    add(names ? Json("id") : row["id"]);
    for (const char* group : {"parameters", "metrics"}) {
      for (const auto& [key, value] : row[group].items()) add(names ? Json(key) : value);
    }
    add(names ? Json("neighbors") : row["neighbors"]);
    for (const auto& [key, value] : row["radius"].items())
      add(names ? Json("radius_" + key) : value);
    for (const char* key : {"orphans", "left_out", "seconds", "shared", "picture"}) {
      add(names ? Json(key) : row[key]);
    }
    text += cells + "\n";
  };
  for (const Json& row : json_["rows"]) {
    if (text.empty()) line(row, true);
    line(row, false);
  }
  return text;
}

}  // namespace psf::study
