// Lists of values for every parameter of the filter, as options of psf sweep, converge and tune.
#pragma once

#include <CLI/CLI.hpp>
#include <vector>

#include "filter/parameters/text.h"

namespace psf::tools {

// Lists as written, by the name of the parameter (study/parameter_lists.h).
struct ParameterLists : filter::ParameterTexts {};

void add_parameter_lists(CLI::App& command, ParameterLists& lists);

// Every combination of values. Throws what study::combinations() and validate() throw.
[[nodiscard]] std::vector<filter::Parameters> all_sets(const ParameterLists& lists);

}  // namespace psf::tools
