// The rows about writing: the cost of a dump in bytes and in render time.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/rows.h"

namespace psf::bench {

// The overhead of the file `raw` in bytes that are not values, and the size of the stored values of
// the file `zstd`. `is_real`: the values are a renderer's, so that the target for their size
// applies.
[[nodiscard]] std::vector<Row> size_rows(const std::string& raw, const std::string& zstd,
                                         bool is_real);

struct RenderRun {
  std::string scene;
  std::string options;  // further options of psf-render, separated by spaces
  std::size_t passes = 16;
  std::size_t threads = 0;  // 0: all cores
  std::string folder;       // folder for the files that it writes
};

// Runs the psf-render in the folder of this program in turn with and without a dump. Throws
// Error{io} where it cannot be run, Error{bad_input} where it fails.
[[nodiscard]] std::vector<Row> render_rows(const RenderRun& run, std::size_t repeat);

}  // namespace psf::bench
