// Files that are being written, and are removed where the program ends before they are complete.
#pragma once

#include <string>

namespace psf::core {

// A file or an empty folder that is removed when this object is destroyed, or when a signal ends
// the program, unless keep() was called. It need not exist.
class Unfinished {
 public:
  explicit Unfinished(const std::string& path);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  void keep() noexcept;  // call it when the file is complete, or has another name

 private:
  char* path_;
  bool placed_ = false;  // the path is in the list of those that a signal removes
};

// Removes all unfinished files; for signal handlers that end the program.
void remove_unfinished() noexcept;

}  // namespace psf::core
