#include "render/scene/whole_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/error.h"

namespace psf::render {
namespace fs = std::filesystem;

std::size_t open_whole(const std::string& path, std::ifstream& file) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::io, path + ": " + what);
  };
  if (fs::is_directory(status)) fail("is a folder, a file is needed");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    fail("is no regular file, and it may have to be read more than once; save it as a file");
  }
  errno = 0;
  file.open(path, std::ios::binary);
  if (!file) fail(fmt::format("cannot open: {}", std::strerror(errno)));
  file.seekg(0, std::ios::end);
  const auto size = static_cast<std::size_t>(file.tellg());
  file.seekg(0);
  check_read(path, file);
  return size;
}

void check_read(const std::string& path, const std::ifstream& file) {
  if (file) return;
  throw Error(ErrorCode::io, fmt::format("{}: cannot read: {}", path, std::strerror(errno)));
}

}  // namespace psf::render
