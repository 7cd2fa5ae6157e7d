// The output of psf explain: text for people, JSON for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "explain/attribution.h"
#include "run/dump.h"

namespace psf::tools {

struct ExplainReport {
  const run::Dump& dump;
  const explain::ExplainResult& explanation;
  const explain::Attribution& whence;
  std::size_t top = 5;    // most rows of a table
  bool vertices = false;  // show all values of each path's vertex
};

// The pixel, its vertices, and a comparison of its value with that of its own paths.
[[nodiscard]] std::string explain_overview(const ExplainReport& report);
// Tables of what the weights refused, where the light came from, what would have refused it, and
// the paths.
[[nodiscard]] std::string explain_tables(const ExplainReport& report);
// Everything, whatever `top` is. The neighbours of a path are arrays of equal length, one per
// column.
[[nodiscard]] nlohmann::ordered_json explain_json(const ExplainReport& report);

}  // namespace psf::tools
