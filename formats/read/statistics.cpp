#include "formats/read/statistics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace psf::formats {
namespace {

constexpr std::size_t kChunksRead = 64;  // chunks between two reports of progress

using Components = std::vector<ComponentStatistics>;

template <class T>
void add(std::span<const T> values, Components& to) {
  const std::size_t components = to.size();
  for (std::size_t c = 0; c < components; ++c) {
    ComponentStatistics& out = to[c];
    for (std::size_t k = c; k < values.size(); k += components) {
      const auto value = static_cast<double>(values[k]);
      if (!std::isfinite(value)) {
        ++out.non_finite;
        continue;
      }
      ++out.finite;
      out.min = std::min(out.min, value);
      out.max = std::max(out.max, value);
      out.sum += value;
    }
  }
}

template <class T>
void read_and_add(const TableReader& reader, std::size_t channel, const ChunkEntry& entry,
                  Components& to) {
  std::vector<T> values(entry.count * to.size());
  if constexpr (std::is_same_v<T, float>) {
    reader.read_floats(channel, entry.first, entry.count, values);
  } else {
    reader.read(channel, entry.first, entry.count, std::as_writable_bytes(std::span(values)));
  }
  add<T>(values, to);
}

void add_chunk(const TableReader& reader, std::size_t k, const ChunkEntry& entry, Components& to) {
  const Channel& channel = reader.schema().channels[k];
  if (channel.encoding != Encoding::plain) return read_and_add<float>(reader, k, entry, to);
  switch (channel.type) {
    case Type::u8:
      return read_and_add<std::uint8_t>(reader, k, entry, to);
    case Type::u16:
      return read_and_add<std::uint16_t>(reader, k, entry, to);
    case Type::u32:
      return read_and_add<std::uint32_t>(reader, k, entry, to);
    case Type::u64:
      return read_and_add<std::uint64_t>(reader, k, entry, to);
    case Type::f16:
    case Type::f32:
      return read_and_add<float>(reader, k, entry, to);
    case Type::f64:
      return read_and_add<double>(reader, k, entry, to);
  }
}

void merge(const Components& from, Components& to) {
  for (std::size_t c = 0; c < to.size(); ++c) {
    to[c].finite += from[c].finite;
    to[c].non_finite += from[c].non_finite;
    to[c].min = std::min(to[c].min, from[c].min);
    to[c].max = std::max(to[c].max, from[c].max);
    to[c].sum += from[c].sum;
  }
}

}  // namespace

std::vector<ChannelSize> channel_sizes(const TableReader& reader) {
  const Schema& schema = reader.schema();
  const std::span<const ChunkEntry> chunks = reader.chunks();
  std::vector<ChannelSize> sizes(schema.channels.size());
  for (std::size_t begin = 0; begin < chunks.size(); begin += kChunksRead) {
    const std::size_t end = std::min(begin + kChunksRead, chunks.size());
    std::vector<std::vector<Column>> columns(end - begin);
    tbb::parallel_for(begin, end, [&](std::size_t k) { columns[k - begin] = reader.columns(k); });
    for (std::size_t k = begin; k < end; ++k) {
      for (const Column& column : columns[k - begin]) {
        ChannelSize& size = sizes[column.channel];
        size.raw += chunks[k].count * std::uint64_t{schema.channels[column.channel].stride()};
        size.stored += column.stored;
        ++(column.codec == Codec::raw ? size.raw_columns : size.zstd_columns);
      }
    }
  }
  return sizes;
}

std::vector<ComponentStatistics> channel_statistics(
    const TableReader& reader, std::size_t channel,
    const std::function<void(std::size_t)>& progress) {
  const std::span<const ChunkEntry> chunks = reader.chunks();
  const Components empty(reader.schema().channels.at(channel).decoded_components());
  Components total = empty;
  for (std::size_t begin = 0; begin < chunks.size(); begin += kChunksRead) {
    const std::size_t end = std::min(begin + kChunksRead, chunks.size());
    std::vector<Components> parts(end - begin, empty);
    tbb::parallel_for(begin, end, [&](std::size_t k) {
      add_chunk(reader, channel, chunks[k], parts[k - begin]);
    });
    for (const Components& part : parts) merge(part, total);
    if (progress) progress(end);
  }
  return total;
}

}  // namespace psf::formats
