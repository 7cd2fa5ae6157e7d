#include "run/layer_columns.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>

#include "core/parallel.h"
#include "core/vec.h"

namespace psf::run {
namespace {

using filter::PathRange;

// What there is in some values.
struct Seen {
  bool finite = true, zero = true;  // all of them
};

Seen look_at(std::span<const float> values) {
  constexpr std::uint32_t kSign = 1u << 31, kMostFinite = 0x7f7fffff;
  std::uint32_t any = 0, not_finite = 0;
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    any |= bits;
    const auto size = static_cast<std::int32_t>(bits & ~kSign);
    not_finite |= size > static_cast<std::int32_t>(kMostFinite) ? 1u : 0u;
  }
  return {not_finite == 0, any == 0};
}

// What is not finite would take all that is averaged with it along, also in other layers' sums.
// Returns how many values that were.
std::uint64_t make_finite(std::span<Rgb> values) {
  std::uint64_t not_finite = 0;
  for (Rgb& value : values) {
    if (is_finite(value)) continue;
    value = Rgb(0, 0, 0);
    ++not_finite;
  }
  return not_finite;
}

// The parts of a range that lie in a chunk each.
std::vector<PathRange> by_chunks(const formats::Reader& reader, const PathRange& range) {
  std::vector<PathRange> parts;
  const std::span<const formats::ChunkEntry> all = reader.chunks();
  auto chunk = std::partition_point(all.begin(), all.end(), [&](const formats::ChunkEntry& entry) {
    return entry.first + entry.count <= range.first;
  });
  for (; chunk != all.end() && chunk->first < range.last; ++chunk) {
    parts.push_back(
        {std::max(range.first, chunk->first), std::min(range.last, chunk->first + chunk->count)});
  }
  return parts;
}

// Returns how many values were not finite.
std::uint64_t read_column(const formats::Reader& reader, const PathRange& range, std::size_t place,
                          std::vector<Rgb>& column) {
  const auto size = static_cast<std::size_t>(range.size());
  if (reader.table(0).is_known_to_be_zero(place, range.first, size)) {
    column.clear();
    return 0;
  }
  if (column.capacity() < size) column = {};  // no old values beside the new ones
  column.resize(size);
  const std::vector<PathRange> parts = by_chunks(reader, range);
  std::vector<std::uint64_t> not_finite(parts.size(), 0);
  std::vector<char> zero(parts.size(), 0);
  core::parallel_for(parts.size(), 1, [&](std::size_t k, std::size_t) {
    const std::span<Rgb> part =
        std::span(column).subspan(static_cast<std::size_t>(parts[k].first - range.first),
                                  static_cast<std::size_t>(parts[k].size()));
    const std::span<float> values(&part[0].x, 3 * part.size());
    reader.read_floats(place, parts[k].first, part.size(), values);
    const Seen seen = look_at(values);  // while it is in the cache
    if (!seen.finite) not_finite[k] = make_finite(part);
    zero[k] = seen.zero ? 1 : 0;
  });
  if (std::find(zero.begin(), zero.end(), 0) == zero.end()) column.clear();
  return std::accumulate(not_finite.begin(), not_finite.end(), std::uint64_t{0});
}

}  // namespace

void add_layer_tasks(const formats::Reader& reader, const PathRange& range,
                     std::span<const LightLayer> layers, BlockRecords& out,
                     std::vector<std::function<void()>>& tasks) {
  out.layers.resize(layers.size());
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const auto add = [&](const std::optional<std::size_t>& place,
                         BlockRecords::LayerColumns::Column& column) {
      column.not_finite = 0;
      if (!place) return column.values.clear();
      tasks.push_back([&reader, &range, &column, place = *place] {
        column.not_finite = read_column(reader, range, place, column.values);
      });
    };
    add(layers[k].contribution, out.layers[k].contribution);
    add(layers[k].unfiltered, out.layers[k].unfiltered);
  }
}

}  // namespace psf::run
