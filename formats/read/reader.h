// Reads a path-vertex buffer up to its last commit: any range of records of any channel, from any
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/layout/entries.h"
#include "formats/layout/head.h"

namespace psf::formats {

class Reader {
 public:
  // Throws Error{io} where the file cannot be opened, Error{bad_input} where it is no readable
  // path-vertex buffer, was written by a later version, or is damaged before its last commit.
  explicit Reader(const std::string& path);
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] const Head& head() const;
  [[nodiscard]] std::uint64_t records() const;         // number of committed records
  [[nodiscard]] std::span<const Pass> passes() const;  // committed, in order, without gaps
  [[nodiscard]] bool closed() const;                   // the producer has closed the file
  [[nodiscard]] std::uint64_t uncommitted_bytes()
      const;                               // bytes after the last commit; normal after a kill
  [[nodiscard]] std::string uuid() const;  // the file's uuid as text

  // Takes in what was committed since the file was opened or last refreshed; returns whether there
  // was anything. Must not be called while other threads use the reader. Throws what the
  // constructor throws, and Error{bad_input} where another file now has the name.
  bool refresh();
  // Whether a program has the file open to write it.
  [[nodiscard]] bool is_being_written() const;

  [[nodiscard]] std::uint64_t file_bytes() const;
  // The resume state that the producer gave to its last commit.
  [[nodiscard]] std::vector<std::byte> resume_state() const;
  [[nodiscard]] std::span<const ChunkEntry> chunks() const;  // committed, in order, without gaps
  // The columns of a chunk, one per channel, in the channels' order. Thread-safe. Throws
  // Error{bad_input} that names the chunk.
  [[nodiscard]] std::vector<Column> columns(std::size_t chunk) const;

  // The index of a channel. Where it is missing, throws Error{bad_input} that names the file, the
  // channel and what needs it.
  [[nodiscard]] std::size_t require(std::string_view channel, std::string_view wanted_by) const;

  // Reads the records [first, first + count) as stored; out.size() is count * Channel::stride().
  // Thread-safe. Throws Error{bad_input} that names chunk, channel and records where a checksum is
  // wrong.
  void read(std::size_t channel, std::uint64_t first, std::size_t count,
            std::span<std::byte> out) const;
  // Reads records of an f16, f32, f64 or octahedral channel as floats; out.size() is count *
  // Channel::decoded_components().
  void read_floats(std::size_t channel, std::uint64_t first, std::size_t count,
                   std::span<float> out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace psf::formats
