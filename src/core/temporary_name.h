// What a file or a folder is called until it is whole.
#pragma once

#include <string>

namespace psf::core {

// Beside `path`: hidden, with its extension, its stem cut where the name would be longer than the
// file system takes.
[[nodiscard]] std::string temporary_name(const std::string& path);

}  // namespace psf::core
