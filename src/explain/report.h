// What is said of an explained pixel: text for people, JSON for programs.
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "explain/attribution.h"
#include "run/dump.h"

namespace psf::explain {

struct Report {
  const run::Dump& dump;
  const ExplainResult& explanation;
  const Attribution& whence;
  std::size_t top = 5;    // most rows of a table
  bool vertices = false;  // show all values of each path's vertex
};

// The pixel, its vertices, and a comparison of its value with that of its own paths.
[[nodiscard]] std::string overview(const Report& report);
// Tables of what the weights refused, where the light came from, what would have refused it, and
// the paths.
[[nodiscard]] std::string tables(const Report& report);
// Everything as JSON, one line, whatever `top` is. The neighbours of a path are arrays of equal
// length, one per column.
[[nodiscard]] std::string json(const Report& report);

inline constexpr std::size_t kAllRows = std::numeric_limits<std::size_t>::max();

}  // namespace psf::explain
