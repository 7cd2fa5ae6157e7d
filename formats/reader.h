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

#include "formats/head.h"
#include "formats/writer.h"

namespace psf::formats {

enum class Filter : std::uint8_t;  // see codec.h

struct Pass {
  std::uint64_t first = 0;  // number of the first record
  std::uint64_t count = 0;
};

// The place of a chunk, as in the index of the file.
struct ChunkEntry {
  std::uint64_t offset = 0, length = 0;  // place and size of its frame, bytes
  std::uint64_t first = 0;               // number of the first record
  std::uint32_t count = 0;
  std::uint32_t pass = 0;
  bool operator==(const ChunkEntry&) const = default;
};

// One channel of one chunk, as stored.
struct Column {
  std::uint16_t channel = 0;
  Codec codec = Codec::raw;
  Filter filter{};
  std::uint32_t crc = 0;     // checksum of the stored bytes
  std::uint64_t offset = 0;  // place in the frame
  std::uint64_t stored = 0;  // number of stored bytes
};

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
