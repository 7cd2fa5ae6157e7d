// Statistics of the values and the sizes of the columns of the paths, or of a table, by channel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "formats/read/table_reader.h"

namespace psf::formats {

struct ChannelSize {
  std::uint64_t raw = 0, stored = 0;                // bytes
  std::uint64_t raw_columns = 0, zstd_columns = 0;  // numbers of columns by codec
};

// The sizes of each channel. Reads directories only. Throws Error{bad_input} that names the chunk.
[[nodiscard]] std::vector<ChannelSize> channel_sizes(const TableReader& reader);

struct ComponentStatistics {
  std::uint64_t finite = 0, non_finite = 0;
  double min = std::numeric_limits<double>::infinity();  // min, max and sum are of finite values
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;

  [[nodiscard]] double mean() const { return finite > 0 ? sum / static_cast<double>(finite) : 0; }
};

// The statistics of each component of the decoded values of a channel. The chunks are read in
// parallel; the result is the same for any number of threads. Calls `progress` with the number of
// chunks done, from the calling thread.
[[nodiscard]] std::vector<ComponentStatistics> channel_statistics(
    const TableReader& reader, std::size_t channel,
    const std::function<void(std::size_t)>& progress = {});

}  // namespace psf::formats
