// "FIRST:LAST", a range of passes as the command line has it.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "formats/error.h"
#include "option_values.h"
#include "study/filter_dump.h"

namespace psf::tools {

constexpr const char* kPassesHelp = "only these passes, from 0, LAST not included";

// A whole number of passes; throws Error{usage} that names the option.
inline std::uint64_t parse_pass(const std::string& text, const char* option) {
  if (const auto number = parse_number<std::uint64_t>(text)) return *number;
  throw Error(ErrorCode::usage, fmt::format("{}: '{}' is no number of passes", option, text));
}

// LAST is not included; both may be left out. Empty: all passes.
inline study::PassSelection parse_passes(const std::string& text, const char* option = "--passes") {
  study::PassSelection selection;
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
