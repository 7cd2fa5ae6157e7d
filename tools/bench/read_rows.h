// The rows about reading: raw columns against pread of the same bytes, zstd, some channels against
// all, and opening a file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/rows.h"

namespace psf::bench {

// `raw` and `zstd` are files with the same records. The first repetition, which is not counted,
// brings their bytes into the page cache.
[[nodiscard]] std::vector<Row> read_rows(const std::string& raw, const std::string& zstd,
                                         std::size_t repeat);

// The time to open a sparse file of more than 200 GB, which is made at `path`.
[[nodiscard]] Row open_row(const std::string& path, std::size_t repeat);

}  // namespace psf::bench
