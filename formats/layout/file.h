// A POSIX file: positioned reads and writes that are whole or throw Error{io} with path and remedy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace psf::formats {

class File {
 public:
  // Opens a regular file for reading.
  [[nodiscard]] static File open(const std::string& path);
  // Open a file for writing: create() empties it, update() leaves it as it is. Throws Error{io}
  // where another process is writing the file. The lock ends with the File.
  [[nodiscard]] static File create(const std::string& path);
  [[nodiscard]] static File update(const std::string& path);
  // Whether a process holds the lock of the file `path`; false where there is no such file.
  [[nodiscard]] static bool is_being_written(const std::string& path);

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  [[nodiscard]] const std::string& path() const { return path_; }
  void set_path(const std::string& path) { path_ = path; }  // for messages, after a rename
  [[nodiscard]] std::uint64_t size() const;
  // Whether path() is still the name of this file, and not of another file or of none.
  [[nodiscard]] bool is_named() const;

  // Reads bytes until `out` is full; throws where the file ends before. Thread-safe.
  void read_at(std::uint64_t offset, std::span<std::byte> out) const;
  // Writes the parts one behind the other; at most 1024 of them.
  void write_at(std::uint64_t offset, std::span<const std::span<const std::byte>> parts);
  void sync();  // fdatasync
  void truncate(std::uint64_t size);
  void flush();  // like close(), but the file stays open and locked
  void close();  // throws where the system could not store what was written

 private:
  File(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  [[noreturn]] void fail(const char* action) const;
  [[nodiscard]] static File open_locked(const std::string& path, int flags, const char* action);
  void check_regular() const;

  std::string path_;
  int descriptor_ = -1;
};

// Renames a file; with `sync` the new name is made durable.
void rename_file(const std::string& from, const std::string& to, bool sync);

}  // namespace psf::formats
