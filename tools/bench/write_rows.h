// Writing: what a dump costs in bytes, and what it costs the render.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/rows.h"

namespace psf::bench {

// Bytes of `raw` that are no values, and of the values of `zstd` those that are stored. `is_real`:
// the values are a renderer's, so that the target of their size counts.
[[nodiscard]] std::vector<Row> size_rows(const std::string& raw, const std::string& zstd,
                                         bool is_real);

struct RenderRun {
  std::string scene;
  std::string options;  // more of psf-render's, separated by spaces
  std::size_t passes = 16;
  std::size_t threads = 0;  // 0: all cores
  std::string folder;       // for what it writes
};

// Runs the psf-render beside this program in turn with and without a dump. Throws Error{io} where
// it cannot be run, Error{bad_input} where it fails.
[[nodiscard]] std::vector<Row> render_rows(const RenderRun& run, std::size_t repeat);

}  // namespace psf::bench
