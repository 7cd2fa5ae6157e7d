// What --version says: the version, and what it was built from and with.
#pragma once

#include <string>

namespace psf::tools {

// `instructions`: what the filter's engine uses on this machine; empty for programs without it.
[[nodiscard]] std::string version_text(const std::string& program,
                                       const std::string& instructions = "");

}  // namespace psf::tools
