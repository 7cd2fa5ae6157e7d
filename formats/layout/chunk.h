// The directory of the frames CHNK and TCHK: the range of its records, and the place of each
// column.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/layout/codec.h"
#include "formats/layout/entries.h"
#include "formats/layout/frame.h"
#include "formats/layout/head.h"

namespace psf::formats {

struct Chunk {
  std::size_t table = 0;    // 0: of the paths; else as Head::schema() counts
  std::uint64_t first = 0;  // number of the first record, in its table
  std::uint32_t count = 0;
  std::uint32_t pass = 0;
  std::vector<Column> columns;  // one per channel, in the channels' order
};

// Whether a frame of a file is a chunk: CHNK, or TCHK where the file has tables.
[[nodiscard]] bool is_chunk(std::uint32_t frame_type, const Head& head);

[[nodiscard]] std::vector<std::byte> encode_chunk(const Chunk& chunk);
// Throws Error{bad_input} that says what breaks the rules of version 1 (the caller adds file and
// chunk). The columns of the result lie within the frame and within the limits.
[[nodiscard]] Chunk decode_chunk(const Frame& frame, const Head& head);

// Reads, checks and decodes a column; `out` has the size of its decoded bytes. Throws
// Error{bad_input} that says what is wrong with the column. Thread-safe.
void read_column(const File& file, std::uint64_t frame_offset, const Column& column,
                 std::span<std::byte> out);

// Whether a column, of `size` decoded bytes, is all 0 and so little is stored that telling so is
// cheap: true is certain, false may be wrong. Throws what read_column() throws. Thread-safe.
[[nodiscard]] bool is_known_to_be_zero(const File& file, std::uint64_t frame_offset,
                                       const Column& column, std::size_t size);

// Reads a column without decoding it, for a copy; its stored bytes lie in `storage`. Thread-safe.
[[nodiscard]] EncodedColumn read_stored(const File& file, std::uint64_t frame_offset,
                                        const Column& column, Buffer& storage);

// A range of records as text: "records 0-65535"; of a table: "table
// vertices: records 0-65535".
[[nodiscard]] std::string record_range(std::uint64_t first, std::uint64_t count);
[[nodiscard]] std::string table_range(const Head& head, std::size_t table, std::uint64_t first,
                                      std::uint64_t count);

}  // namespace psf::formats
