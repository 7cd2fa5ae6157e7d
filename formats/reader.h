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
  std::uint64_t first = 0;  // record
  std::uint64_t count = 0;
};

// Where a chunk lies, as the index of the file has it.
struct ChunkEntry {
  std::uint64_t offset = 0, length = 0;  // of its frame, bytes
  std::uint64_t first = 0;               // record
  std::uint32_t count = 0;
  std::uint32_t pass = 0;
  bool operator==(const ChunkEntry&) const = default;
};

// One channel of one chunk, as stored.
struct Column {
  std::uint16_t channel = 0;
  Codec codec = Codec::raw;
  Filter filter{};
  std::uint32_t crc = 0;     // of the stored bytes
  std::uint64_t offset = 0;  // in the frame
  std::uint64_t stored = 0;  // bytes
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
  [[nodiscard]] std::uint64_t records() const;         // committed
  [[nodiscard]] std::span<const Pass> passes() const;  // committed, in order, without gaps
  [[nodiscard]] bool closed() const;                   // the producer said that it was done
  [[nodiscard]] std::uint64_t uncommitted_bytes()
      const;                               // after the last commit: normal after a kill
  [[nodiscard]] std::string uuid() const;  // of the file, as text

  // Takes in what was committed since: true where there is more. Not while other threads use the
  // reader. Throws what the constructor throws, and Error{bad_input} where another file now has the
  // name.
  bool refresh();
  // Whether a program has the file open to write it.
  [[nodiscard]] bool is_being_written() const;

  [[nodiscard]] std::uint64_t file_bytes() const;
  // What the producer handed to its last commit.
  [[nodiscard]] std::vector<std::byte> resume_state() const;
  [[nodiscard]] std::span<const ChunkEntry> chunks() const;  // committed, in order, without gaps
  // One a channel, in their order. Thread-safe. Throws Error{bad_input} that names the chunk.
  [[nodiscard]] std::vector<Column> columns(std::size_t chunk) const;

  // Index of a channel; throws Error{bad_input} that names the file, the channel and who needs it.
  [[nodiscard]] std::size_t require(std::string_view channel, std::string_view wanted_by) const;

  // Records [first, first + count) as stored: out.size() == count * stride. Thread-safe. Throws
  // Error{bad_input} naming chunk, channel and records where a checksum is wrong.
  void read(std::size_t channel, std::uint64_t first, std::size_t count,
            std::span<std::byte> out) const;
  // The same as floats, from f16, f32, f64 or octahedral: out.size() == count *
  // decoded_components().
  void read_floats(std::size_t channel, std::uint64_t first, std::size_t count,
                   std::span<float> out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace psf::formats
