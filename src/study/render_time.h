// What rendering took, for speed-ups of a convergence study.
#pragma once

#include <span>
#include <string>

namespace psf::study {

// The seconds that rendering a pass takes, as in psf-render's --json.
struct RenderTime {
  double render = 0;  // without writing the dump
  double dump = 0;    // for writing the dump
};

// The figures of a render as psf-render --json writes them. `name`: the file, for errors.
struct RenderFigures {
  std::string name, json;
};

// Means over renders. Throws Error{bad_input} for what is none.
[[nodiscard]] RenderTime mean_render_time(std::span<const RenderFigures> renders);
// The same of files. Throws Error{io} where one cannot be read.
[[nodiscard]] RenderTime read_render_time(std::span<const std::string> paths);

}  // namespace psf::study
