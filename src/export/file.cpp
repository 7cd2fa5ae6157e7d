#include "export/file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/error.h"

namespace psf::exports {

ExportFile::ExportFile(const std::string& path, std::string shown)
    : shown_(std::move(shown)), file_(std::fopen(path.c_str(), "wb")) {
  if (!file_) fail();
}

void ExportFile::write(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail();
  bytes_ += bytes.size();
}

void ExportFile::close() {
  if (std::fclose(file_.release()) != 0) fail();
}

void ExportFile::fail() const {
  const int error = errno;
  throw Error(ErrorCode::io, fmt::format("{}: cannot write: {}{}", shown_, std::strerror(error),
                                         error == ENOSPC || error == EFBIG
                                             ? "; free some space or choose another disk"
                                             : ""));
}

}  // namespace psf::exports
