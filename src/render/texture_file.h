// What a picture file says of its pixels, as OpenImageIO tells it.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/vec.h"
#include "render/texture.h"

namespace psf::render {

// Which channels are the colour; alpha only where the colour is premultiplied by it.
struct ColourChannels {
  std::size_t red = 0, green = 0, blue = 0;
  std::optional<std::size_t> alpha;
};

// Throws Error{bad_input} naming the file for what is no picture of colours in a plane: volumes,
// cube maps, luminance with chroma.
void refuse_layout(const std::string& name, const OIIO::ImageSpec& spec);

// R, G and B where channels are called so, in the first layer that has them; else the first three,
// or the first for grey.
[[nodiscard]] ColourChannels colour_channels(const std::string& name, const OIIO::ImageSpec& spec,
                                             TextureUse use, std::vector<std::string>& notes);

// Stored value to linear one. Throws Error{bad_input} for a logarithmic scale.
[[nodiscard]] std::function<float(float)> transfer_curve(const std::string& name,
                                                         const OIIO::ImageSpec& spec,
                                                         TextureUse use, bool plain);

// To the primaries and the white of Rec. 709, for row vectors; nothing where the file has them or
// does not say.
[[nodiscard]] std::optional<Imath::M33f> to_rec709(const OIIO::ImageSpec& spec);

// Where the texels of the picture, as it is to be seen, lie in the file.
class TexelMap {
 public:
  // Throws Error{bad_input} where none of the data is to be seen.
  TexelMap(const std::string& name, const OIIO::ImageSpec& spec);
  // Of the picture.
  [[nodiscard]] std::size_t width() const { return turned_ ? full_height_ : full_width_; }
  [[nodiscard]] std::size_t height() const { return turned_ ? full_width_ : full_height_; }
  // Index in the data of the texel in column x of row y; nothing where the file has none.
  [[nodiscard]] std::optional<std::size_t> stored(std::size_t x, std::size_t y) const;

 private:
  std::size_t full_width_, full_height_;  // of the display window
  std::size_t data_width_, data_height_;
  std::ptrdiff_t data_x_ = 0, data_y_ = 0;  // in the display window
  int orientation_;                         // of EXIF, 1 to 8
  bool turned_;                             // width and height change places
};

}  // namespace psf::render
