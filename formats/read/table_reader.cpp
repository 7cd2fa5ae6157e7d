#include "formats/read/table_reader.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <utility>

#include "core/error.h"
#include "formats/layout/quantize.h"

namespace psf::formats {
namespace {

// The passes of a table of a file with so many passes.
std::vector<Pass> passes_of(std::span<const ChunkEntry> chunks, std::uint64_t count) {
  std::vector<Pass> passes(static_cast<std::size_t>(count));
  for (const ChunkEntry& entry : chunks) passes[entry.pass].count += entry.count;
  std::uint64_t first = 0;
  for (Pass& pass : passes) {
    pass.first = first;
    first += pass.count;
  }
  return passes;
}

}  // namespace

TableReader::TableReader(const File& file, const Opened& opened, std::size_t table)
    : file_(file), opened_(opened), table_(table), cache_(kCacheBytes) {
  refresh();
}

void TableReader::refresh() {
  passes_ = passes_of(chunks(), opened_.commit.passes);
}

void TableReader::fail(const std::string& why) const {
  throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file_.path(), why));
}

void TableReader::fail_chunk(std::size_t chunk, const std::string& why) const {
  const ChunkEntry& entry = chunks()[chunk];
  fail(fmt::format("{}chunk {} ({}) at byte {}: {}; 'psf verify' names every fault", prefix(),
                   chunk, record_range(entry.first, entry.count), entry.offset, why));
}

std::string TableReader::prefix() const {
  return table_ == 0 ? "" : fmt::format("table {}: ", name());
}

Chunk TableReader::chunk_directory(std::size_t chunk) const {
  const ChunkEntry& entry = chunks()[chunk];
  const FrameResult result = read_frame(file_, opened_.file_size, entry.offset, &opened_.uuid);
  if (result.state != FrameState::whole) fail_chunk(chunk, result.fault);
  Chunk found = decoded(chunk, result.frame);
  if (result.frame.prefix.length != entry.length || found.table != table_ ||
      found.first != entry.first || found.count != entry.count || found.pass != entry.pass) {
    fail_chunk(chunk, "another chunk stands in its place");
  }
  return found;
}

Chunk TableReader::decoded(std::size_t chunk, const Frame& frame) const {
  try {
    return decode_chunk(frame, opened_.head);
  } catch (const Error& error) {
    fail_chunk(chunk, error.what());
  }
}

// Calls use(column) for a whole column.
template <class Use>
void TableReader::use_whole(std::size_t chunk, std::size_t k, const Use& use) const {
  const Chunk found = chunk_directory(chunk);
  try {
    use(found.columns[k]);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::io) throw;
    fail_chunk(chunk, fmt::format("channel {}: {}", channel(k).name, error.what()));
  }
}

// A whole column; `out` has its size.
void TableReader::read_whole(std::size_t chunk, std::size_t k, std::span<std::byte> out) const {
  use_whole(chunk, k,
            [&](const Column& column) { read_column(file_, chunks()[chunk].offset, column, out); });
}

ColumnCache::Bytes TableReader::column(std::size_t chunk, std::size_t k) const {
  if (ColumnCache::Bytes found = cache_.find(chunk, k)) return found;
  auto bytes =
      std::make_shared<std::vector<std::byte>>(chunks()[chunk].count * channel(k).stride());
  read_whole(chunk, k, *bytes);
  cache_.insert(chunk, k, bytes);
  return bytes;
}

// Calls part(chunk, first record within the chunk, count, records of the range before it) for
// every chunk of a range, in parallel.
template <class Part>
void TableReader::for_chunks(std::uint64_t first, std::size_t count, const Part& part) const {
  if (first > records() || count > records() - first) {
    throw Error(ErrorCode::usage,
                fmt::format("{}: {}{} asked for, but the file has {}", file_.path(), prefix(),
                            record_range(first, count), records()));
  }
  if (count == 0) return;
  const std::span<const ChunkEntry> all = chunks();
  const auto chunk_of = [&](std::uint64_t record) {
    const auto behind =
        std::upper_bound(all.begin(), all.end(), record,
                         [](std::uint64_t r, const ChunkEntry& entry) { return r < entry.first; });
    return static_cast<std::size_t>(behind - all.begin()) - 1;
  };
  const auto one = [&](std::size_t chunk) {
    const ChunkEntry& entry = all[chunk];
    const std::uint64_t begin = std::max(entry.first, first);
    const std::uint64_t end = std::min(entry.first + entry.count, first + count);
    part(chunk, static_cast<std::size_t>(begin - entry.first),
         static_cast<std::size_t>(end - begin), static_cast<std::size_t>(begin - first));
  };
  const std::size_t from = chunk_of(first), to = chunk_of(first + count - 1) + 1;
  if (to - from == 1) {
    one(from);
  } else {
    tbb::parallel_for(from, to, one);
  }
}

// Records [first, first + count) of one chunk.
void TableReader::read_part(std::size_t chunk, std::size_t k, std::size_t first, std::size_t count,
                            std::span<std::byte> out) const {
  if (count == chunks()[chunk].count) return read_whole(chunk, k, out);
  const ColumnCache::Bytes bytes = column(chunk, k);
  const std::size_t stride = channel(k).stride();
  std::memcpy(out.data(), bytes->data() + first * stride, count * stride);
}

void TableReader::check_size(std::size_t got, std::size_t wanted) const {
  if (got == wanted) return;
  throw Error(ErrorCode::usage, fmt::format("{}: room for {} values given where {} are read",
                                            file_.path(), got, wanted));
}

std::vector<Column> TableReader::columns(std::size_t chunk) const {
  return chunk_directory(chunk).columns;
}

std::size_t TableReader::require(std::string_view wanted, std::string_view wanted_by) const {
  if (const auto found = schema().find(wanted)) return *found;
  fail(
      fmt::format("{}has no channel {}, which {} needs; switch that off, or write the "
                  "channel when rendering",
                  prefix(), wanted, wanted_by));
}

void TableReader::read(std::size_t k, std::uint64_t first, std::size_t count,
                       std::span<std::byte> out) const {
  const std::size_t stride = channel(k).stride();
  check_size(out.size(), count * stride);
  for_chunks(first, count,
             [&](std::size_t chunk, std::size_t begin, std::size_t length, std::size_t before) {
               read_part(chunk, k, begin, length, out.subspan(before * stride, length * stride));
             });
}

bool TableReader::is_known_to_be_zero(std::size_t k, std::uint64_t first, std::size_t count) const {
  std::atomic<bool> zero{true};
  for_chunks(first, count, [&](std::size_t chunk, std::size_t, std::size_t, std::size_t) {
    if (!zero) return;
    use_whole(chunk, k, [&](const Column& column) {
      if (!formats::is_known_to_be_zero(file_, chunks()[chunk].offset, column,
                                        chunks()[chunk].count * channel(k).stride())) {
        zero = false;
      }
    });
  });
  return zero;
}

void TableReader::read_floats(std::size_t k, std::uint64_t first, std::size_t count,
                              std::span<float> out) const {
  const Channel& stored_as = channel(k);
  const bool octahedral = stored_as.encoding == Encoding::octahedral;
  if (stored_as.type == Type::f32) return read(k, first, count, std::as_writable_bytes(out));
  if (!octahedral && stored_as.type != Type::f16 && stored_as.type != Type::f64) {
    fail(fmt::format("{}channel {} holds {}, no floating-point numbers", prefix(), stored_as.name,
                     name_of(stored_as.type)));
  }
  const std::size_t wide = stored_as.decoded_components();
  check_size(out.size(), count * wide);
  for_chunks(first, count,
             [&](std::size_t chunk, std::size_t begin, std::size_t length, std::size_t before) {
               const std::size_t values = length * stored_as.components;
               const std::span<float> to = out.subspan(before * wide, length * wide);
               if (stored_as.type == Type::f64) {
                 std::vector<double> stored(values);
                 read_part(chunk, k, begin, length, std::as_writable_bytes(std::span(stored)));
                 std::transform(stored.begin(), stored.end(), to.begin(),
                                [](double value) { return static_cast<float>(value); });
                 return;
               }
               std::vector<std::uint16_t> stored(values);
               read_part(chunk, k, begin, length, std::as_writable_bytes(std::span(stored)));
               if (octahedral) {
                 decode_octahedral(stored, to);
               } else {
                 decode_half(stored, to);
               }
             });
}

}  // namespace psf::formats
