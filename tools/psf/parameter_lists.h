// Lists of values for every parameter of the filter, as psf sweep, converge and tune take them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "filter/parameters.h"

namespace psf::tools {

// As written: "2px,4px", "2px:32px:x2", "0.1:0.5:0.1", "0.9,off". Empty: the default alone.
struct ParameterLists {
  std::string r0, delta, radius_count, block, normal, reflectance, visibility, hit_distance, plane,
      direction, gloss, material, demodulate, iterations, sources, estimator, agree;
  bool no_weights = false;  // no terms but those given
};

void add_parameter_lists(CLI::App& command, ParameterLists& lists);

// Every combination, r0 and delta running fastest. Throws Error{usage} naming the option and what
// it may be, and where there are more than kMostSets.
inline constexpr std::size_t kMostSets = 100000;
[[nodiscard]] std::vector<filter::Parameters> all_sets(const ParameterLists& lists);

// The values of one list. A range A:B:xF goes from A by factors of F up to B, A:B:S by steps of S;
// a unit behind the numbers is that of both.
[[nodiscard]] std::vector<std::string> list_values(const std::string& text, const char* option);

}  // namespace psf::tools
