// Reading: raw columns against pread of the same bytes, zstd, some channels against all, opening.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/rows.h"

namespace psf::bench {

// `raw` and `zstd` hold the same records. Their bytes are in the page cache from the first,
// uncounted repetition on.
[[nodiscard]] std::vector<Row> read_rows(const std::string& raw, const std::string& zstd,
                                         std::size_t repeat);

// Of a sparse file of more than 200 GB, made at `path`.
[[nodiscard]] Row open_row(const std::string& path, std::size_t repeat);

}  // namespace psf::bench
