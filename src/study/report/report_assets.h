// The parts of the report's page that do not depend on the study, embedded in the program.
#pragma once

#include <string_view>

namespace psf::study::report_assets {

std::string_view page();     // the HTML around everything, with @NAME@ where a part goes
std::string_view style();    // CSS
std::string_view scripts();  // our own JavaScript
std::string_view d3();       // the plots' library
std::string_view licence();  // the library's

}  // namespace psf::study::report_assets
