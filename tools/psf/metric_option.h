// The option --metric.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "metrics/metrics.h"

namespace psf::tools {

// Adds --metric, whose names the help lists; metrics::parse_metric() checks the text later.
inline void add_metric(CLI::App& command, std::string& metric, const std::string& help) {
  std::string names;
  for (const metrics::Metric one : metrics::kAllMetrics) {
    names += (names.empty() ? "{" : ",") + std::string(metrics::name(one));
  }
  command.add_option("--metric", metric, help)->type_name(names + "}")->capture_default_str();
}

}  // namespace psf::tools
