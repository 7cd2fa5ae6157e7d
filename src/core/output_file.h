// A file that appears under its name only when whole.
#pragma once

#include <optional>
#include <string>

#include "core/unfinished.h"

namespace psf::core {

// Write to temporary_path(), then call commit(), which renames it over `path`. Where `path` is a
// symbolic link, the link stays and its target is replaced. Without commit() the destructor removes
// the temporary file, as does a signal that ends the program, and an earlier file stays as it was.
class OutputFile {
 public:
  // Throws Error{io} where the folder is missing or not writable, or where `path` is a folder or
  // write-protected, so that no work is done in vain.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // The name of the temporary file. It is in the same folder as the file and has its extension, so
  // that libraries that look at the extension write the right format, and is no longer than the
  // file system allows. For a device or a pipe it is `path` itself.
  [[nodiscard]] const std::string& temporary_path() const { return temporary_; }
  void commit();

 private:
  std::string path_, target_, temporary_;
  std::optional<Unfinished> unfinished_;
};

// The path that `path` leads to when symbolic links in its last part are followed. The file need
// not exist.
[[nodiscard]] std::string followed(const std::string& path);

// Makes a folder, and those above it, where it is missing. Throws Error{io}.
void make_folder(const std::string& path);

// Writes a file that holds `text`, by OutputFile. Throws Error{io}.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace psf::core
