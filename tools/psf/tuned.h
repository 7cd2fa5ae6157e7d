// Reads the parameters that psf tune chose from the file that it wrote.
#pragma once

#include <string>

#include "filter_options.h"

namespace psf::tools {

// Throws Error{io} where the file cannot be read, Error{bad_input} where psf tune did not write it.
void read_tuned(const std::string& path, filter::ParameterTexts& options);

}  // namespace psf::tools
