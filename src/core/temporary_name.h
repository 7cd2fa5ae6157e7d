// The name of a file or a folder until it is complete.
#pragma once

#include <string>

namespace psf::core {

// A hidden name in the folder of `path`, with the process id and the extension of `path`. The stem
// is cut where the name would be longer than the file system allows.
[[nodiscard]] std::string temporary_name(const std::string& path);

}  // namespace psf::core
