#include "core/output_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace psf::core {
namespace fs = std::filesystem;

OutputFile::OutputFile(const std::string& path) : path_(path) {
  const fs::path target(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!target.has_filename() || fs::is_directory(target)) {
    throw Error(ErrorCode::io, path + ": is a folder, a file name is needed");
  }
  if (!fs::is_directory(folder)) {
    throw Error(ErrorCode::io,
                path + ": the folder " + folder.string() + " does not exist, create it first");
  }
  // A device or a pipe takes bytes as they come; renaming would put a plain file in its place.
  if (fs::exists(target) && !fs::is_regular_file(target)) {
    temporary_ = path_;
    return;
  }
  temporary_ = (folder / ("." + target.stem().string() + "." + std::to_string(getpid()) +
                          ".partial" + target.extension().string()))
                   .string();
  if (!std::ofstream(temporary_, std::ios::binary)) {
    throw Error(ErrorCode::io, path + ": cannot write here: " + std::strerror(errno));
  }
}

OutputFile::~OutputFile() {
  if (!committed_ && temporary_ != path_) std::remove(temporary_.c_str());
}

void OutputFile::commit() {
  if (temporary_ != path_ && std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    throw Error(ErrorCode::io,
                path_ + ": cannot put the finished file in place: " + std::strerror(errno));
  }
  committed_ = true;
}

void write_text_file(const std::string& path, const std::string& text) {
  OutputFile file(path);
  {
    std::ofstream out(file.temporary_path(), std::ios::binary);
    out << text;
    out.close();
    if (!out) throw Error(ErrorCode::io, path + ": cannot write: " + std::strerror(errno));
  }
  file.commit();
}

}  // namespace psf::core
