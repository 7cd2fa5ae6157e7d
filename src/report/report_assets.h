// The parts of the report's page that do not depend on the study, embedded in the program.
#pragma once

#include <string_view>

namespace psf::report::assets {

std::string_view page();     // the HTML around everything, with @NAME@ where a part goes
std::string_view style();    // CSS
std::string_view scripts();  // our own JavaScript
std::string_view d3();       // the library that draws the plots
std::string_view licence();  // the licence of this library

}  // namespace psf::report::assets
