// What psf explain says of a pixel: for people as text, for programs as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "study/dump.h"
#include "study/explain/explain_whence.h"

namespace psf::tools {

struct ExplainReport {
  const study::Dump& dump;
  const study::Explanation& explanation;
  const study::Whence& whence;
  std::size_t top = 5;    // rows of a table at most
  bool vertices = false;  // with all values of each path's vertex
};

// The pixel, its vertices, and what it is against its own paths.
[[nodiscard]] std::string explain_overview(const ExplainReport& report);
// What the weights refused, whence the light came, what would have refused it, the paths.
[[nodiscard]] std::string explain_tables(const ExplainReport& report);
// Everything, whatever `top`. The neighbours of a path are arrays by column, of equal length.
[[nodiscard]] nlohmann::ordered_json explain_json(const ExplainReport& report);

}  // namespace psf::tools
