// What the metadata of a dump list, as tables of psf info.
#pragma once

#include <string>

#include "formats/metadata.h"

namespace psf::tools {

// Cameras, lights and materials, those there are.
void print_tables(const formats::Metadata& metadata);

// Text of a file may hold what a terminal obeys; "-" for none.
[[nodiscard]] std::string shown_or_dash(std::string text);

}  // namespace psf::tools
