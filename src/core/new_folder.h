// A folder for the results of one run, which goes again where the run does not end well.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/unfinished.h"

namespace psf::core {

// Without keep(), its destructor, or a signal that ends the program, removes the files that were
// added, and the folders that were made where nothing else is in them by then.
class NewFolder {
 public:
  // Makes the folder, and those above it, where it is missing. Throws Error{io}.
  explicit NewFolder(const std::string& path);
  ~NewFolder();
  NewFolder(NewFolder&&) noexcept = default;
  NewFolder& operator=(NewFolder&&) = delete;

  // A file that the run has written, or is about to.
  void add(const std::string& path);
  void keep() noexcept;

 private:
  std::vector<std::unique_ptr<Unfinished>> folders_;  // the innermost first
  std::vector<std::unique_ptr<Unfinished>> files_;
};

}  // namespace psf::core
