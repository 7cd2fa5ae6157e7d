// Reads the records of the paths, or of one table, of an open path-vertex buffer: any range of any
// channel, from any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/layout/chunk.h"
#include "formats/layout/entries.h"
#include "formats/layout/file.h"
#include "formats/layout/head.h"
#include "formats/read/column_cache.h"
#include "formats/read/open.h"

namespace psf::formats {

// A Reader owns one for the paths and one for each table. All methods are thread-safe.
class TableReader {
 public:
  // The most bytes of decoded columns that it keeps, beside the last one.
  static constexpr std::size_t kCacheBytes = std::size_t{32} << 20;

  // `table` as Head::schema() counts; file and index stay where they are.
  TableReader(const File& file, const Opened& opened, std::size_t table);
  TableReader(const TableReader&) = delete;
  TableReader& operator=(const TableReader&) = delete;

  [[nodiscard]] std::string_view name() const { return opened_.head.table_name(table_); }
  [[nodiscard]] const Schema& schema() const { return opened_.head.schema(table_); }
  [[nodiscard]] std::uint64_t records() const { return opened_.commit.records_of(table_); }
  // One for each pass of the file, in order, without gaps; of a table it may be without records.
  [[nodiscard]] std::span<const Pass> passes() const { return passes_; }
  [[nodiscard]] std::span<const ChunkEntry> chunks() const { return opened_.chunks[table_]; }
  // The columns of a chunk, one per channel, in the channels' order. Throws Error{bad_input} that
  // names the chunk.
  [[nodiscard]] std::vector<Column> columns(std::size_t chunk) const;

  // The index of a channel. Where it is missing, throws Error{bad_input} that names the file, the
  // channel and what needs it.
  [[nodiscard]] std::size_t require(std::string_view wanted, std::string_view wanted_by) const;

  // Reads the records [first, first + count) of channel k as stored; out.size() is count *
  // Channel::stride(). Throws Error{bad_input} that names chunk, channel and records where a
  // checksum is wrong.
  void read(std::size_t k, std::uint64_t first, std::size_t count, std::span<std::byte> out) const;
  // Reads records of an f16, f32, f64 or octahedral channel as floats; out.size() is count *
  // Channel::decoded_components().
  void read_floats(std::size_t k, std::uint64_t first, std::size_t count,
                   std::span<float> out) const;
  // Whether the records [first, first + count) of channel k are known to be 0 in all their bytes
  // without reading them: true is certain, false may be wrong. Throws what read() throws.
  [[nodiscard]] bool is_known_to_be_zero(std::size_t k, std::uint64_t first,
                                         std::size_t count) const;

  // The start of a message about it: "table vertices: ", empty for the paths.
  [[nodiscard]] std::string prefix() const;
  // Takes in what the index has got since.
  void refresh();

 private:
  [[noreturn]] void fail(const std::string& why) const;
  [[noreturn]] void fail_chunk(std::size_t chunk, const std::string& why) const;
  [[nodiscard]] const Channel& channel(std::size_t k) const { return schema().channels.at(k); }
  [[nodiscard]] Chunk chunk_directory(std::size_t chunk) const;
  [[nodiscard]] Chunk decoded(std::size_t chunk, const Frame& frame) const;
  template <class Use>
  void use_whole(std::size_t chunk, std::size_t k, const Use& use) const;
  void read_whole(std::size_t chunk, std::size_t k, std::span<std::byte> out) const;
  [[nodiscard]] ColumnCache::Bytes column(std::size_t chunk, std::size_t k) const;
  void read_part(std::size_t chunk, std::size_t k, std::size_t first, std::size_t count,
                 std::span<std::byte> out) const;
  template <class Part>
  void for_chunks(std::uint64_t first, std::size_t count, const Part& part) const;
  void check_size(std::size_t got, std::size_t wanted) const;

  const File& file_;
  const Opened& opened_;
  std::size_t table_;
  std::vector<Pass> passes_;
  mutable ColumnCache cache_;
};

}  // namespace psf::formats
