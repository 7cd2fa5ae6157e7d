// What the columns of a path-vertex buffer hold and what they cost, by channel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "formats/reader.h"

namespace psf::formats {

struct ChannelSize {
  std::uint64_t raw = 0, stored = 0;                // bytes
  std::uint64_t raw_columns = 0, zstd_columns = 0;  // by codec
};

// One a channel. Reads directories only. Throws Error{bad_input} that names the chunk.
[[nodiscard]] std::vector<ChannelSize> channel_sizes(const Reader& reader);

struct ComponentStatistics {
  std::uint64_t finite = 0, non_finite = 0;
  double min = std::numeric_limits<double>::infinity();  // of the finite values, like the rest
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;

  [[nodiscard]] double mean() const { return finite > 0 ? sum / static_cast<double>(finite) : 0; }
};

// Of each component of the decoded values of a channel. Parallel over chunks; the same for any
// number of threads. `progress(chunks done)` is called from the calling thread.
[[nodiscard]] std::vector<ComponentStatistics> channel_statistics(
    const Reader& reader, std::size_t channel,
    const std::function<void(std::size_t)>& progress = {});

}  // namespace psf::formats
