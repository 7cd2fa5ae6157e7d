// Names of what is being written and must not stay where the program ends before it is whole.
#pragma once

#include <string>

namespace psf {

// A file or an empty folder that is removed when this is destroyed, or when a signal ends the
// program, unless it was kept. It needs not be there.
class Unfinished {
 public:
  explicit Unfinished(const std::string& path);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  void keep() noexcept;  // it is whole, or has another name

 private:
  char* path_;
  bool placed_ = false;  // among those that a signal removes
};

// Removes all of them. For signal handlers that end the program.
void remove_unfinished() noexcept;

}  // namespace psf
