// Reads the parameters that psf tune chose from the file that it wrote.
#pragma once

#include <string>

#include "filter_options.h"

namespace psf::tools {

// `vertex`: the rule as written, which becomes that of the file where it is empty. Throws Error{io}
// where the file cannot be read, Error{bad_input} where psf tune did not write it.
void read_tuned(const std::string& path, filter::ParameterTexts& options, std::string& vertex);

}  // namespace psf::tools
