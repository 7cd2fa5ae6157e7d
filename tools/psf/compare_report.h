// The results of psf compare, as text and JSON.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/text.h"
#include "metrics/errors.h"
#include "metrics/metrics.h"

namespace psf::tools {

struct CompareRow {
  std::string region;  // "X,Y,WxH"; empty: the whole picture
  metrics::Metrics values;
};

struct CompareReport {
  std::string picture, layer, reference;
  metrics::MetricOptions options;
  metrics::Metric first = metrics::Metric::rel_mse;  // printed first
  double trim = 0;
  std::vector<CompareRow> rows;
};

inline std::vector<metrics::Metric> in_order(metrics::Metric first) {
  std::vector<metrics::Metric> metrics = {first};
  for (const metrics::Metric metric : metrics::kAllMetrics) {
    if (metric != first) metrics.push_back(metric);
  }
  return metrics;
}

inline std::string value_text(metrics::Metric metric, double value, int digits = 6) {
  return metric == metrics::Metric::psnr ? fmt::format("{:.2f} dB", value)
                                         : fmt::format("{:.{}g}", value, digits);
}

// Prints one metric per line for the whole picture, or one region per line.
inline void print_values(const CompareReport& report) {
  const std::vector<metrics::Metric> metrics = in_order(report.first);
  if (report.rows.front().region.empty()) {
    for (const metrics::Metric metric : metrics) {
      const std::string settings = metrics::settings(metric, report.options);
      const std::string text = value_text(metric, report.rows.front().values[metric]);
      fmt::print("{:<6} {}\n", metrics::name(metric),
                 settings.empty() ? text : fmt::format("{:<9}  ({})", text, settings));
    }
    return;
  }
  constexpr int kDigits = 4;
  fmt::print("{:<18}", "region");
  for (const metrics::Metric metric : metrics) fmt::print("{:>11}", metrics::name(metric));
  fmt::print("\n");
  for (const CompareRow& row : report.rows) {
    fmt::print("{:<18}", row.region);
    for (const metrics::Metric metric : metrics) {
      fmt::print("{:>11}", value_text(metric, row.values[metric], kDigits));
    }
    fmt::print("\n");
  }
  std::vector<std::pair<std::string, std::string>> notes;  // names of metrics, their settings
  for (const metrics::Metric metric : metrics) {
    const std::string settings = metrics::settings(metric, report.options);
    const auto same = std::find_if(notes.begin(), notes.end(),
                                   [&](const auto& note) { return note.second == settings; });
    if (same != notes.end()) {
      same->first += fmt::format(", {}", metrics::name(metric));
    } else if (!settings.empty()) {
      notes.emplace_back(metrics::name(metric), settings);
    }
  }
  for (const auto& [names, settings] : notes) fmt::print("{}: {}\n", names, settings);
}

inline void print_left_out(const CompareReport& report) {
  for (const CompareRow& row : report.rows) {
    const std::string where = row.region.empty() ? "" : row.region + ": ";
    const metrics::Metrics& values = row.values;
    if (report.trim > 0) {
      fmt::print("{}left out of each metric: the {} of the largest error, of {}\n", where,
                 core::counted(values.trimmed, "pixel", "pixels"),
                 core::with_commas(values.pixels + values.trimmed));
    }
    if (values.non_finite > 0) {
      fmt::print("{}left out: {} not finite in {} or {}\n", where,
                 core::counted(values.non_finite, "pixel", "pixels"), report.picture,
                 report.reference);
    }
  }
}

inline nlohmann::ordered_json to_json(const CompareReport& report) {
  using Json = nlohmann::ordered_json;
  Json metrics = Json::array(), rows = Json::array();
  for (const metrics::Metric metric : in_order(report.first)) {
    metrics.push_back({{"name", metrics::name(metric)},
                       {"lower_is_better", metrics::lower_is_better(metric)},
                       {"settings", metrics::settings(metric, report.options)}});
  }
  for (const CompareRow& row : report.rows) {
    Json values;
    for (const metrics::Metric metric : in_order(report.first)) {
      values[metrics::name(metric)] = row.values[metric];  // null where it is no number
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
