// A file that appears under its name only when whole.
#pragma once

#include <optional>
#include <string>

#include "core/unfinished.h"

namespace psf::core {

// Write to temporary_path(), then commit(), which renames it over `path`; a symbolic link stays and
// the file that it leads to is replaced. Without commit the destructor removes the temporary, and
// so does a signal that ends the program: what was there before is left.
class OutputFile {
 public:
  // Throws Error{io} at once where the folder is missing or not writable, where `path` is a folder
  // or write-protected, before any work is done for it.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Beside the file and with its extension, so that libraries which look at the extension write the
  // right format. Its name is no longer than the file system takes. A device or a pipe: itself.
  [[nodiscard]] const std::string& temporary_path() const { return temporary_; }
  void commit();

 private:
  std::string path_, target_, temporary_;
  std::optional<Unfinished> unfinished_;
};

// Where `path` leads: through symbolic links of its last part, also to a file that is not there
// yet.
[[nodiscard]] std::string followed(const std::string& path);

// Writes `text` as a whole file.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace psf::core
