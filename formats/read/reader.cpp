#include "formats/read/reader.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "formats/layout/chunk.h"
#include "formats/layout/head_frame.h"
#include "formats/layout/layout.h"
#include "formats/layout/quantize.h"
#include "formats/read/column_cache.h"
#include "formats/read/open.h"

namespace psf::formats {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{32} << 20;

std::vector<Pass> passes_of(std::span<const ChunkEntry> chunks) {
  std::vector<Pass> passes;
  for (const ChunkEntry& entry : chunks) {
    if (entry.pass == passes.size()) passes.push_back({entry.first, 0});
    passes.back().count += entry.count;
  }
  return passes;
}

}  // namespace

struct Reader::State {
  explicit State(const std::string& path)
      : file(File::open(path)), opened(open_buffer(file)), passes(passes_of(opened.chunks)) {}

  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file.path(), why));
  }
  [[noreturn]] void fail_chunk(std::size_t chunk, const std::string& why) const {
    const ChunkEntry& entry = opened.chunks[chunk];
    fail(fmt::format("chunk {} ({}) at byte {}: {}; 'psf verify' names every fault", chunk,
                     record_range(entry.first, entry.count), entry.offset, why));
  }
  [[nodiscard]] const Channel& channel(std::size_t k) const { return opened.head.channels.at(k); }

  [[nodiscard]] Chunk chunk_directory(std::size_t chunk) const {
    const ChunkEntry& entry = opened.chunks[chunk];
    const FrameResult result = read_frame(file, opened.file_size, entry.offset, &opened.uuid);
    if (result.state != FrameState::whole) fail_chunk(chunk, result.fault);
    Chunk found = decoded(chunk, result.frame);
    if (result.frame.prefix.length != entry.length || found.first != entry.first ||
        found.count != entry.count || found.pass != entry.pass) {
      fail_chunk(chunk, "another chunk stands in its place");
    }
    return found;
  }

  [[nodiscard]] Chunk decoded(std::size_t chunk, const Frame& frame) const {
    try {
      return decode_chunk(frame, opened.head);
    } catch (const Error& error) {
      fail_chunk(chunk, error.what());
    }
  }

  // A whole column; `out` has its size.
  void read_whole(std::size_t chunk, std::size_t k, std::span<std::byte> out) const {
    const Chunk found = chunk_directory(chunk);
    try {
      read_column(file, opened.chunks[chunk].offset, found.columns[k], out);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::io) throw;
      fail_chunk(chunk, fmt::format("channel {}: {}", channel(k).name, error.what()));
    }
  }

  [[nodiscard]] ColumnCache::Bytes column(std::size_t chunk, std::size_t k) const {
    if (ColumnCache::Bytes found = cache.find(chunk, k)) return found;
    auto bytes =
        std::make_shared<std::vector<std::byte>>(opened.chunks[chunk].count * channel(k).stride());
    read_whole(chunk, k, *bytes);
    cache.insert(chunk, k, bytes);
    return bytes;
  }

  // Calls part(chunk, first record within the chunk, count, records of the range before it) for
  // every chunk of a range, in parallel.
  template <class Part>
  void for_chunks(std::uint64_t first, std::size_t count, const Part& part) const {
    const std::uint64_t records = opened.commit.records;
    if (first > records || count > records - first) {
      throw Error(ErrorCode::usage, fmt::format("{}: {} asked for, but the file has {}",
                                                file.path(), record_range(first, count), records));
    }
    if (count == 0) return;
    const auto& chunks = opened.chunks;
    const auto chunk_of = [&](std::uint64_t record) {
      const auto behind = std::upper_bound(
          chunks.begin(), chunks.end(), record,
          [](std::uint64_t r, const ChunkEntry& entry) { return r < entry.first; });
      return static_cast<std::size_t>(behind - chunks.begin()) - 1;
    };
    const auto one = [&](std::size_t chunk) {
      const ChunkEntry& entry = chunks[chunk];
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
  void read_part(std::size_t chunk, std::size_t k, std::size_t first, std::size_t count,
                 std::span<std::byte> out) const {
    if (count == opened.chunks[chunk].count) return read_whole(chunk, k, out);
    const ColumnCache::Bytes bytes = column(chunk, k);
    const std::size_t stride = channel(k).stride();
    std::memcpy(out.data(), bytes->data() + first * stride, count * stride);
  }

  void check_size(std::size_t got, std::size_t wanted) const {
    if (got == wanted) return;
    throw Error(ErrorCode::usage, fmt::format("{}: room for {} values given where {} are read",
                                              file.path(), got, wanted));
  }

  File file;
  Opened opened;
  std::vector<Pass> passes;
  mutable ColumnCache cache{kCacheBytes};
};

Reader::Reader(const std::string& path) : state_(std::make_unique<State>(path)) {}
Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

bool Reader::refresh() {
  State& state = *state_;
  if (!state.file.is_named()) state.fail("was replaced by another file while it was being read");
  if (state.file.size() <= state.opened.last.end()) return false;
  Opened now = open_buffer(state.file);
  const bool more = now.commit.number > state.opened.commit.number;
  state.opened = std::move(now);
  if (more) state.passes = passes_of(state.opened.chunks);
  return more;
}

bool Reader::is_being_written() const {
  return File::is_being_written(path());
}

const std::string& Reader::path() const {
  return state_->file.path();
}
const Head& Reader::head() const {
  return state_->opened.head;
}
std::uint64_t Reader::records() const {
  return state_->opened.commit.records;
}
std::span<const Pass> Reader::passes() const {
  return state_->passes;
}
bool Reader::closed() const {
  return (state_->opened.commit.flags & kClosed) != 0;
}
std::uint64_t Reader::uncommitted_bytes() const {
  return state_->opened.file_size - state_->opened.last.end();
}
std::string Reader::uuid() const {
  return to_text(state_->opened.uuid);
}
std::uint64_t Reader::file_bytes() const {
  return state_->opened.file_size;
}
std::span<const ChunkEntry> Reader::chunks() const {
  return state_->opened.chunks;
}

std::vector<std::byte> Reader::resume_state() const {
  try {
    return read_section(state_->file, state_->opened.last, state_->opened.commit.resume);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::io) throw;
    state_->fail(fmt::format("resume state of the commit at byte {}: {}",
                             state_->opened.last.prefix.offset, error.what()));
  }
}

std::vector<Column> Reader::columns(std::size_t chunk) const {
  return state_->chunk_directory(chunk).columns;
}

std::size_t Reader::require(std::string_view channel, std::string_view wanted_by) const {
  if (const auto found = head().find(channel)) return *found;
  state_->fail(
      fmt::format("has no channel {}, which {} needs; switch that off, or write the "
                  "channel when rendering",
                  channel, wanted_by));
}

void Reader::read(std::size_t channel, std::uint64_t first, std::size_t count,
                  std::span<std::byte> out) const {
  const std::size_t stride = state_->channel(channel).stride();
  state_->check_size(out.size(), count * stride);
  state_->for_chunks(
      first, count,
      [&](std::size_t chunk, std::size_t begin, std::size_t length, std::size_t before) {
        state_->read_part(chunk, channel, begin, length,
                          out.subspan(before * stride, length * stride));
      });
}

void Reader::read_floats(std::size_t k, std::uint64_t first, std::size_t count,
                         std::span<float> out) const {
  const Channel& channel = state_->channel(k);
  const bool octahedral = channel.encoding == Encoding::octahedral;
  if (channel.type == Type::f32) return read(k, first, count, std::as_writable_bytes(out));
  if (!octahedral && channel.type != Type::f16 && channel.type != Type::f64) {
    state_->fail(fmt::format("channel {} holds {}, no floating-point numbers", channel.name,
                             name_of(channel.type)));
  }
  const std::size_t wide = channel.decoded_components();
  state_->check_size(out.size(), count * wide);
  state_->for_chunks(
      first, count,
      [&](std::size_t chunk, std::size_t begin, std::size_t length, std::size_t before) {
        const std::size_t values = length * channel.components;
        const std::span<float> to = out.subspan(before * wide, length * wide);
        if (channel.type == Type::f64) {
          std::vector<double> stored(values);
          state_->read_part(chunk, k, begin, length, std::as_writable_bytes(std::span(stored)));
          std::transform(stored.begin(), stored.end(), to.begin(),
                         [](double value) { return static_cast<float>(value); });
          return;
        }
        std::vector<std::uint16_t> stored(values);
        state_->read_part(chunk, k, begin, length, std::as_writable_bytes(std::span(stored)));
        if (octahedral) {
          decode_octahedral(stored, to);
        } else {
          decode_half(stored, to);
        }
      });
}

}  // namespace psf::formats
