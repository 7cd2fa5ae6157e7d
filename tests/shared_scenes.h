// The folder of scenes that the project did not make and does not hold.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace psf::tests {

// What PSF_SCENES names, else "shared/scenes" beside the project; empty where there is no such
// folder. A test that needs it is skipped then.
[[nodiscard]] inline std::string shared_scenes() {
  namespace fs = std::filesystem;
  const char* named = std::getenv("PSF_SCENES");
  const fs::path folder =
      named != nullptr ? fs::path(named) : fs::path(PSF_SOURCE_DIR) / "../shared/scenes";
  return fs::is_directory(folder) ? folder.string() : "";
}

}  // namespace psf::tests
