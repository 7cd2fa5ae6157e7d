// A texture: linear RGB floats, bilinear, repeating. Files are read by OpenImageIO.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/vec.h"

namespace psf::render {

enum class ColorSpace { srgb, linear };  // of 8-bit files; float files are linear whatever is asked

class Texture {
 public:
  // (height, width) colours, row 0 at v = 1 (the top of the picture).
  Texture(std::size_t width, std::size_t height, std::vector<Rgb> texels);
  // Throws Error{io} where the file is missing, Error{bad_input} where it is no picture; both name the file.
  static Texture load(const std::string& path, ColorSpace color_space);

  [[nodiscard]] Rgb at(const Vec2& uv) const;  // u to the right, v up
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  [[nodiscard]] const Rgb& texel(std::size_t x, std::size_t y) const { return texels_[y * width_ + x]; }

 private:
  std::size_t width_, height_;
  std::vector<Rgb> texels_;
};

}  // namespace psf::render
