// Text on pictures of 8 bits: a plain font of strokes with round ends, at any size, with smooth
// edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace psf::film {

using Byte3 = std::array<std::uint8_t, 3>;  // sRGB

// A picture to draw on.
struct Canvas {
  Canvas(std::size_t width, std::size_t height, const Byte3& color);

  // (width, height) pixels at `values`, (height, width, 3), with their corner at (x, y); they must
  // lie on the canvas.
  void place(std::size_t x, std::size_t y, std::size_t width, std::size_t height,
             const std::uint8_t* values);

  std::size_t width, height;
  std::vector<std::uint8_t> values;  // (height, width, 3), row 0 at the top
};

// How text looks. `size`: the height of a capital in pixels.
struct Lettering {
  double size = 14;
  Byte3 color = {0, 0, 0};
};

// The width in pixels that a text takes. Letters that are not printable ASCII show as '?'.
[[nodiscard]] double text_width(std::string_view text, double size);

// Draws a text whose first letter begins at x and whose letters stand on y. What is beyond the
// canvas is left out.
void draw_text(Canvas& canvas, double x, double y, std::string_view text, const Lettering& how);

}  // namespace psf::film
