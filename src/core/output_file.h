// A file that appears under its name only when whole.
#pragma once

#include <string>

namespace psf::core {

// Write to temporary_path(), then commit(), which renames it over `path`. Without commit the
// destructor removes the temporary, so a failed or interrupted run leaves what was there before.
class OutputFile {
 public:
  // Throws Error{io} at once where the folder is missing or not writable, before any work is done
  // for it.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Beside `path` and with its extension, so that libraries which look at the extension write the
  // right format.
  [[nodiscard]] const std::string& temporary_path() const { return temporary_; }
  void commit();

 private:
  std::string path_, temporary_;
  bool committed_ = false;
};

// Writes `text` as a whole file.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace psf::core
