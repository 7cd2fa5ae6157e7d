// Parses a range of passes, or of frames, on the command line, "FIRST:LAST".
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <optional>
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

// FIRST:LAST, where LAST is not included and both may be left out.
struct NumberRange {
  std::uint64_t first = 0;
  std::optional<std::uint64_t> last;
};

// Parses it. Empty text is everything. Throws Error{usage} that names the option.
inline NumberRange parse_range(const std::string& text, const char* option) {
  NumberRange range;
  if (text.empty()) return range;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: '{}': write FIRST:LAST, LAST not included", option, text));
  }
  const auto number = [&](const std::string& part) {
    if (const auto parsed = parse_number<std::uint64_t>(part)) return *parsed;
    throw Error(ErrorCode::usage, fmt::format("{}: '{}' is no whole number", option, part));
  };
  if (colon > 0) range.first = number(text.substr(0, colon));
  if (colon + 1 < text.size()) range.last = number(text.substr(colon + 1));
  return range;
}

// The same for passes.
inline run::PassSelection parse_passes(const std::string& text, const char* option = "--passes") {
  const NumberRange range = parse_range(text, option);
  return {range.first, range.last};
}

}  // namespace psf::tools
