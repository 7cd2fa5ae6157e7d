// A file in memory that is filled anew for each run: no disk, no name that stays behind.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace psf::fuzz {

class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  void set(std::span<const std::byte> bytes);
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

}  // namespace psf::fuzz
