// The time that a renderer took, from the figures that it wrote.
#pragma once

#include <span>
#include <string>

namespace psf::study {

// The seconds that rendering a pass takes.
struct RenderTime {
  double render = 0;  // without writing the dump
  double dump = 0;    // for writing the dump
};

// Means over files that psf-render --json wrote. Throws Error{io} where one cannot be read,
// Error{bad_input} where one lacks a figure.
[[nodiscard]] RenderTime read_render_time(std::span<const std::string> paths);

}  // namespace psf::study
