// The table that psf ablate prints.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "metrics/metrics.h"
#include "study/ablate_file.h"

namespace psf::tools {

// A line for each row, the name of a part before its first; `metric` where anything was compared.
inline void print_ablation(const study::AblateReport& report, metrics::Metric metric) {
  std::size_t label = 0;
  for (const study::AblationRow& row : report.rows) label = std::max(label, row.label.size());
  const bool is_compared = !report.measured.empty();
  const auto error = [&](const std::string& text) {
    return is_compared ? fmt::format("  {:>10}", text) : std::string();
  };
  fmt::print("{:<10}  {:<{}}{}  {:>9}  {:>7}  {:>10}  {:>7}\n", "", "", label,
             error(metrics::name(metric)), "mean", "change", "neighbours", "seconds");
  const study::AblationRow* before = nullptr;
  for (const study::AblationRow& row : report.rows) {
    const bool is_first = before == nullptr || before->part != row.part;
    std::string line =
        fmt::format("{:<10}  {:<{}}{}  {:>#9.4g}", is_first ? name(row.part) : "", row.label, label,
                    error(fmt::format("{:#.4g}", row.metrics[metric])), row.mean);
    if (row.parameters) {
      line += fmt::format("  {:>7}  {:>10.1f}  {:>7.2f}", study::change_text(row), row.neighbors,
                          row.seconds);
    }
    fmt::print("{}\n", line);
    before = &row;
  }
}

}  // namespace psf::tools
