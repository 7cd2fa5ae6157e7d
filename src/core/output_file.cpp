#include "core/output_file.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "core/error.h"
#include "core/temporary_name.h"

namespace psf::core {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::io, path + ": " + why);
}

}  // namespace

std::string temporary_name(const std::string& path) {
  const fs::path target(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const std::string end = "." + std::to_string(getpid()) + ".partial" + target.extension().string();
  const long limit = ::pathconf(folder.c_str(), _PC_NAME_MAX);
  const auto most = static_cast<std::size_t>(limit > 0 ? limit : NAME_MAX);
  const std::size_t room = most - std::min(most, end.size() + 1);
  return (folder / ("." + target.stem().string().substr(0, room) + end)).string();
}

std::string followed(const std::string& path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  fs::path target(path);
  std::error_code error;
  for (int k = 0; k < kMostLinks && fs::is_symlink(fs::symlink_status(target, error)); ++k) {
    target = target.parent_path() / fs::read_symlink(target, error);
  }
  return target.string();
}

OutputFile::OutputFile(const std::string& path) : path_(path), target_(path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  // A device or a pipe takes bytes as they come; renaming would put a plain file in its place.
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) {
    temporary_ = path_;
    return;
  }
  target_ = followed(path);
  const fs::path target(target_);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!target.has_filename() || fs::is_directory(status)) {
    refuse(path, "is a folder, a file name is needed");
  }
  const fs::file_status around = fs::status(folder, error);
  if (around.type() == fs::file_type::not_found) {
    refuse(path, "the folder " + folder.string() + " does not exist, create it first");
  }
  if (!fs::is_directory(around)) {
    refuse(path, "cannot write here: " +
                     (fs::exists(around) ? folder.string() + " is no folder" : error.message()));
  }
  // Renaming asks the folder alone: a file that its owner protects would go all the same.
  if (fs::exists(status) && ::access(target_.c_str(), W_OK) != 0) {
    refuse(path, std::string("cannot write: ") + std::strerror(errno));
  }
  if (target.filename().string().size() > static_cast<std::size_t>(NAME_MAX)) {
    refuse(path, std::string("cannot write: ") + std::strerror(ENAMETOOLONG));
  }
  temporary_ = temporary_name(target_);
  unfinished_.emplace(temporary_);
  if (!std::ofstream(temporary_, std::ios::binary)) {
    refuse(path, std::string("cannot write here: ") + std::strerror(errno));
  }
}

void OutputFile::commit() {
  if (!unfinished_) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) {
    refuse(path_, std::string("cannot put the finished file in place: ") + std::strerror(errno));
  }
  unfinished_->keep();
}

void make_folder(const std::string& path) {
  std::error_code error, other;
  fs::create_directories(path, error);
  if (fs::is_directory(path, other)) return;
  refuse(path, "cannot be made as a folder: " + error.message() + "; give another name");
}

void write_text_file(const std::string& path, const std::string& text) {
  OutputFile file(path);
  {
    std::ofstream out(file.temporary_path(), std::ios::binary);
    out << text;
    out.close();
    if (!out) refuse(path, std::string("cannot write: ") + std::strerror(errno));
  }
  file.commit();
}

}  // namespace psf::core
