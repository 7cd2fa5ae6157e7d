#include "export/output_folder.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/temporary_name.h"

namespace psf::exports {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& path, const std::string& what) : path_(path) {
  while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
  const fs::path target(path_);
  const fs::path parent = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code error;
  const fs::file_status status = fs::symlink_status(target, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    fail(fmt::format("is a file, and {} need a folder; choose another name", what));
  }
  if (fs::exists(status) && !fs::is_empty(target, error)) {
    fail("is a folder with something in it; remove it or choose another name");
  }
  if (!fs::is_directory(parent)) {
    fail(fmt::format("the folder {} does not exist, create it first", parent.string()));
  }
  temporary_ = core::temporary_name(path_);
  unfinished_.emplace_back(temporary_.string());
  fs::create_directory(temporary_, error);
  if (error) fail("cannot create: " + error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void OutputFolder::make_folder(const std::string& name) {
  std::error_code error;
  fs::create_directory(temporary(name), error);
  if (error) fail(fmt::format("cannot create {} in it: {}", name, error.message()));
}

std::string OutputFolder::temporary(const std::string& name) {
  std::string path = (temporary_ / name).string();
  unfinished_.emplace_back(path);
  return path;
}

void OutputFolder::commit() {
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) fail("cannot put the finished folder in place: " + error.message());
  temporary_.clear();
  for (core::Unfinished& part : unfinished_) part.keep();
}

void OutputFolder::fail(const std::string& why) const {
  throw Error(ErrorCode::io, path_ + ": " + why);
}

}  // namespace psf::exports
