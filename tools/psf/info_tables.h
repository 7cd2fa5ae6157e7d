// The lists in the metadata of a dump, as tables of psf info.
#pragma once

#include <string>

#include "formats/layout/metadata.h"

namespace psf::tools {

// Prints tables of the cameras, lights and materials, where there are any.
void print_tables(const formats::Metadata& metadata);

// `text` with '?' for control characters, since text of a file may hold commands for a terminal;
// "-" where it is empty.
[[nodiscard]] std::string shown_or_dash(std::string text);

}  // namespace psf::tools
