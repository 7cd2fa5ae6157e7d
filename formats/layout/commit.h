// The frame CMIT: totals, the index of the chunks, a copy of HEAD, and the producer's resume state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/layout/entries.h"
#include "formats/layout/file.h"
#include "formats/layout/frame.h"

namespace psf::formats {

// A run of bytes in a frame, aligned to 64 bytes.
struct Section {
  std::uint64_t offset = 0, length = 0;
  std::uint32_t crc = 0;
};

// What a commit says of a table beside the paths.
struct TableTotals {
  std::uint64_t records = 0, chunks = 0;  // numbers in the table so far
  std::uint64_t first_chunk = 0;          // number, from 0, of the first chunk of `index`
  std::vector<ChunkEntry> index;          // chunks - first_chunk of them
};

struct Commit {
  std::uint32_t flags = 0;
  std::uint64_t number = 0;                           // from 1
  std::uint64_t records = 0, chunks = 0, passes = 0;  // numbers in the file so far
  std::uint64_t previous = 0;                         // offset of the commit before; 0: none
  std::uint64_t base = 0;         // offset of the commit that ends where this index begins; 0: none
  std::uint64_t first_chunk = 0;  // number, from 0, of the first chunk of this index
  std::uint64_t foreign_required = 0;  // number so far of frames of other, required types
  Section index, head, resume;
  std::vector<TableTotals> tables;  // those of Head::tables

  // The same numbers by table as Head::schema() counts them: 0 for the paths.
  [[nodiscard]] std::uint64_t records_of(std::size_t table) const {
    return table == 0 ? records : tables[table - 1].records;
  }
  [[nodiscard]] std::uint64_t chunks_of(std::size_t table) const {
    return table == 0 ? chunks : tables[table - 1].chunks;
  }
  [[nodiscard]] std::uint64_t first_chunk_of(std::size_t table) const {
    return table == 0 ? first_chunk : tables[table - 1].first_chunk;
  }
};

[[nodiscard]] std::vector<std::byte> encode_commit(const Commit& commit);
// Decodes a commit of a file with so many tables. Throws Error{bad_input} that says what breaks the
// rules of version 1. The sections of the result lie within the frame and within the limits.
[[nodiscard]] Commit decode_commit(const Frame& frame, std::size_t tables);

// Throws Error{bad_input} where the checksum is wrong.
[[nodiscard]] std::vector<std::byte> read_section(const File& file, const Frame& frame,
                                                  const Section& section);

[[nodiscard]] std::vector<std::byte> encode_index(std::span<const ChunkEntry> entries);
[[nodiscard]] std::vector<ChunkEntry> decode_index(std::span<const std::byte> bytes);

// The length of what encode_commit() gives, which has the limit kMaxDirectory.
[[nodiscard]] std::size_t commit_directory(const Commit& commit);

// place_sections() sets the offsets of the sections from their lengths, in the order index, HEAD,
// resume state; commit_length() is the length of the frame.
void place_sections(Commit& commit);
[[nodiscard]] std::uint64_t commit_length(const Commit& commit);

}  // namespace psf::formats
