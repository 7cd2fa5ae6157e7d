// Writes a path-vertex buffer: append records to a pass, commit the pass, close.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "formats/layout/head.h"
#include "formats/write/writer_options.h"

namespace psf::formats {

// The file appears under `path` with its first commit, so a file of this name always holds at least
// one whole pass. Until then it is `path`.partial, which the destructor removes. After an error
// every later call throws it again, and the last commit stays readable. A writer must not be used
// from several threads at once; it compresses the columns of a call in parallel itself.
class Writer {
 public:
  Writer(const std::string& path, const Head& head, const WriterOptions& options = {});
  // Goes on behind the last commit of an existing file, closed or not; what follows this commit is
  // cut off before the first write. Throws Error{io} where another process is writing the file,
  // Error{bad_input} where it cannot be read, or has other channels or another `scene_hash` than
  // `head`; the file then stays as it was. Metadata and chunk capacity stay those of the file.
  [[nodiscard]] static Writer resume(const std::string& path, const Head& head,
                                     const WriterOptions& options = {});
  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  // Appends `count` records to the current pass. columns[k] points at (count, components) values of
  // channel k of the head, contiguous, as stored (native byte order).
  void append(std::size_t count, std::span<const void* const> columns);
  // The same for a table, as Head::schema() counts.
  void append_to(std::size_t table, std::size_t count, std::span<const void* const> columns);
  // Ends the current pass, which has paths. `resume_state`: at most 64 KiB that the producer gets back on resume.
  void commit(std::span<const std::byte> resume_state = {});
  // Writes the last commit again with the flag "closed", unless it already has the flag. It is an
  // error if records were appended after the last commit().
  void close();

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] const Head& head() const;       // the file's own
  [[nodiscard]] std::uint64_t records() const;  // number of committed paths
  [[nodiscard]] std::uint64_t passes() const;   // number of committed passes
  // The resume state of the last commit.
  [[nodiscard]] std::span<const std::byte> resume_state() const;
  [[nodiscard]] std::uint64_t bytes_written() const;

 private:
  struct State;
  explicit Writer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace psf::formats
