// The results of psf compare, as text and JSON.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "study/metrics/errors.h"
#include "study/metrics/metrics.h"
#include "text.h"

namespace psf::tools {

struct CompareRow {
  std::string region;  // "X,Y,WxH"; empty: the whole picture
  study::Metrics values;
};

struct CompareReport {
  std::string picture, layer, reference;
  study::MetricOptions options;
  study::Metric first = study::Metric::rel_mse;  // printed first
  double trim = 0;
  std::vector<CompareRow> rows;
};

inline std::vector<study::Metric> in_order(study::Metric first) {
  std::vector<study::Metric> metrics = {first};
  for (const study::Metric metric : study::kAllMetrics) {
    if (metric != first) metrics.push_back(metric);
  }
  return metrics;
}

inline std::string value_text(study::Metric metric, double value, int digits = 6) {
  return metric == study::Metric::psnr ? fmt::format("{:.2f} dB", value)
                                       : fmt::format("{:.{}g}", value, digits);
}

// Prints one metric per line for the whole picture, or one region per line.
inline void print_values(const CompareReport& report) {
  const std::vector<study::Metric> metrics = in_order(report.first);
  if (report.rows.front().region.empty()) {
    for (const study::Metric metric : metrics) {
      const std::string settings = study::settings(metric, report.options);
      const std::string text = value_text(metric, report.rows.front().values[metric]);
      fmt::print("{:<6} {}\n", study::name(metric),
                 settings.empty() ? text : fmt::format("{:<9}  ({})", text, settings));
    }
    return;
  }
  constexpr int kDigits = 4;
  fmt::print("{:<18}", "region");
  for (const study::Metric metric : metrics) fmt::print("{:>11}", study::name(metric));
  fmt::print("\n");
  for (const CompareRow& row : report.rows) {
    fmt::print("{:<18}", row.region);
    for (const study::Metric metric : metrics) {
      fmt::print("{:>11}", value_text(metric, row.values[metric], kDigits));
    }
    fmt::print("\n");
  }
  std::vector<std::pair<std::string, std::string>> notes;  // names of metrics, their settings
  for (const study::Metric metric : metrics) {
    const std::string settings = study::settings(metric, report.options);
    const auto same = std::find_if(notes.begin(), notes.end(),
                                   [&](const auto& note) { return note.second == settings; });
    if (same != notes.end()) {
      same->first += fmt::format(", {}", study::name(metric));
    } else if (!settings.empty()) {
      notes.emplace_back(study::name(metric), settings);
    }
  }
  for (const auto& [names, settings] : notes) fmt::print("{}: {}\n", names, settings);
}

inline void print_left_out(const CompareReport& report) {
  for (const CompareRow& row : report.rows) {
    const std::string where = row.region.empty() ? "" : row.region + ": ";
    const study::Metrics& values = row.values;
    if (report.trim > 0) {
      fmt::print("{}left out of each metric: the {} of the largest error, of {}\n", where,
                 counted(values.trimmed, "pixel", "pixels"),
                 with_commas(values.pixels + values.trimmed));
    }
    if (values.non_finite > 0) {
      fmt::print("{}left out: {} not finite in {} or {}\n", where,
                 counted(values.non_finite, "pixel", "pixels"), report.picture, report.reference);
    }
  }
}

inline nlohmann::ordered_json to_json(const CompareReport& report) {
  using Json = nlohmann::ordered_json;
  Json metrics = Json::array(), rows = Json::array();
  for (const study::Metric metric : in_order(report.first)) {
    metrics.push_back({{"name", study::name(metric)},
                       {"lower_is_better", study::lower_is_better(metric)},
                       {"settings", study::settings(metric, report.options)}});
  }
  for (const CompareRow& row : report.rows) {
    Json values;
    for (const study::Metric metric : in_order(report.first)) {
      values[study::name(metric)] = row.values[metric];  // null where it is no number
    }
    rows.push_back({{"region", row.region.empty() ? Json(nullptr) : Json(row.region)},
                    {"pixels", row.values.pixels},
                    {"trimmed", row.values.trimmed},
                    {"non_finite", row.values.non_finite},
                    {"metrics", values}});
  }
  return {{"picture", report.picture},
          {"layer", report.layer},
          {"reference", report.reference},
          {"epsilon", report.options.epsilon},
          {"exposure", report.options.exposure},
          {"pixels_per_degree", report.options.pixels_per_degree},
          {"trim", report.trim},
          {"metrics", metrics},
          {"rows", rows}};
}

}  // namespace psf::tools
