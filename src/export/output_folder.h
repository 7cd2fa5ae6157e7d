// A folder that appears under its name only when all that is in it is whole.
#pragma once

#include <deque>
#include <filesystem>
#include <string>

#include "core/unfinished.h"

namespace psf::exports {

// Appears under its name with commit(), and is removed without. Every function throws Error{io}.
class OutputFolder {
 public:
  // The folder must be empty or not exist. `what` will be in it, for messages: "the arrays".
  OutputFolder(const std::string& path, const std::string& what);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Makes a folder in it.
  void make_folder(const std::string& name);
  // Where to write the file of this name, "color.exr" or "left/color.exr", until commit().
  [[nodiscard]] std::string temporary(const std::string& name);
  // What to call it in messages.
  [[nodiscard]] std::string shown(const std::string& name) const { return path_ + "/" + name; }
  void commit();

 private:
  [[noreturn]] void fail(const std::string& why) const;

  std::string path_;
  std::filesystem::path temporary_;
  std::deque<core::Unfinished> unfinished_;  // the folder and what is in it
};

}  // namespace psf::exports
