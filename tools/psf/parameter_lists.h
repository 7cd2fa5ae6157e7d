// Lists of values for every parameter of the filter, for psf sweep, converge and tune.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "filter/parameters/parameters.h"

namespace psf::tools {

// Lists as written: "2px,4px", "2px:32px:x2", "0.1:0.5:0.1", "0.9,off". Where there is none: only the default.
struct ParameterLists {
  std::map<std::string, std::string> given;  // by the name of the parameter
  bool no_weights = false;                   // switch off the terms that are not given
};

void add_parameter_lists(CLI::App& command, ParameterLists& lists);

// Every combination of values; r0 and delta vary fastest. Throws Error{usage} that names an option
// and its possible values, or where there are more than kMostSets combinations.
inline constexpr std::size_t kMostSets = 100000;
[[nodiscard]] std::vector<filter::Parameters> all_sets(const ParameterLists& lists);

// The values of one list. A range A:B:xF goes from A up to B by factors of F, A:B:S by steps of S.
// A unit behind B is that of A and S too.
[[nodiscard]] std::vector<std::string> list_values(const std::string& text,
                                                   const std::string& option);

}  // namespace psf::tools
