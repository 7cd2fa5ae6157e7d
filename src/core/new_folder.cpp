#include "core/new_folder.h"

#include <filesystem>
#include <system_error>

#include "core/output_file.h"

namespace psf::core {
namespace fs = std::filesystem;

NewFolder::NewFolder(const std::string& path) {
  std::error_code error;
  // The last part of "a/b/" is empty and names the same folder as the part before it.
  for (fs::path at = path; !at.empty() && !fs::exists(at, error); at = at.parent_path()) {
    if (at.has_filename()) folders_.push_back(std::make_unique<Unfinished>(at.string()));
  }
  make_folder(path);
}

NewFolder::~NewFolder() {
  files_.clear();
  // A folder can go only when it is empty, so those within it go first.
  for (std::unique_ptr<Unfinished>& folder : folders_) folder.reset();
}

void NewFolder::add(const std::string& path) {
  files_.push_back(std::make_unique<Unfinished>(path));
}

void NewFolder::keep() noexcept {
  for (const auto* all : {&files_, &folders_}) {
    for (const std::unique_ptr<Unfinished>& one : *all) one->keep();
  }
}

}  // namespace psf::core
