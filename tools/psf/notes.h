// Prints remarks for the user, a line each.
#pragma once

#include <string>
#include <vector>

#include "cli.h"
#include "core/standard_streams.h"

namespace psf::tools {

inline void print_notes(const std::vector<std::string>& notes, bool quiet) {
  if (quiet) return;
  for (const std::string& note : notes) core::say("note: " + as_options(note));
}

}  // namespace psf::tools
