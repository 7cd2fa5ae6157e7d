// The directory of the frame CHNK: which records, and where each column lies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/codec.h"
#include "formats/frame.h"
#include "formats/head.h"
#include "formats/reader.h"

namespace psf::formats {

struct Chunk {
  std::uint64_t first = 0;  // record
  std::uint32_t count = 0;
  std::uint32_t pass = 0;
  std::vector<Column> columns;  // one a channel, in their order
};

[[nodiscard]] std::vector<std::byte> encode_chunk(const Chunk& chunk);
// Throws Error{bad_input} that says what breaks the rules of version 1 (the caller adds file and
// chunk). What it returns lies within the frame and within the limits.
[[nodiscard]] Chunk decode_chunk(const Frame& frame, const Head& head);

// Reads a column and checks its checksum; `out` has the size of its records. Throws
// Error{bad_input} saying what is wrong with the column. Thread-safe.
void read_column(const File& file, std::uint64_t frame_offset, const Column& column,
                 std::span<std::byte> out);

// The same column as its stored bytes, which lie in `storage`: for a copy. Thread-safe.
[[nodiscard]] EncodedColumn read_stored(const File& file, std::uint64_t frame_offset,
                                        const Column& column, Buffer& storage);

// "records 0-65535"
[[nodiscard]] std::string record_range(std::uint64_t first, std::uint64_t count);

}  // namespace psf::formats
