// Lists of values for the parameters of the filter, and all their combinations.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filter/parameters/text.h"

namespace psf::study {

// Lists as text by the names of parameters: "2px,4px", "2px:32px:x2", "0.1:0.5:0.1", "0.9,off".
// Every combination of their values, in the order of the parameters; r0 and delta vary fastest.
// Where there is no list: what filter::parameters_of() gives. Throws Error{usage} that names a
// parameter and says what may be written, or where there are more than kMostSets combinations.
inline constexpr std::size_t kMostSets = 100000;
[[nodiscard]] std::vector<filter::ParameterTexts> combinations(const filter::ParameterTexts& lists);

// The values of one list. A range A:B:xF goes from A up to B by factors of F, A:B:S by steps of S.
// A unit behind B is that of A and S too. `name`: the parameter, for errors.
[[nodiscard]] std::vector<std::string> list_values(const std::string& text,
                                                   const std::string& name);

}  // namespace psf::study
