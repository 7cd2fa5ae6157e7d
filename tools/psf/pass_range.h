// Parses a range of passes on the command line, "FIRST:LAST".
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "core/error.h"
#include "option_values.h"
#include "run/filter_dump.h"

namespace psf::tools {

constexpr const char* kPassesHelp = "only these passes, from 0, LAST not included";

// Parses a number of passes. Throws Error{usage} that names the option.
inline std::uint64_t parse_pass(const std::string& text, const char* option) {
  if (const auto number = parse_number<std::uint64_t>(text)) return *number;
  throw Error(ErrorCode::usage, fmt::format("{}: '{}' is no number of passes", option, text));
}

// Parses FIRST:LAST, where LAST is not included and both may be left out. Empty text selects all
// passes.
inline run::PassSelection parse_passes(const std::string& text, const char* option = "--passes") {
  run::PassSelection selection;
  if (text.empty()) return selection;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: '{}': write FIRST:LAST, LAST not included", option, text));
  }
  if (colon > 0) selection.first = parse_pass(text.substr(0, colon), option);
  if (colon + 1 < text.size()) selection.last = parse_pass(text.substr(colon + 1), option);
  return selection;
}

}  // namespace psf::tools
