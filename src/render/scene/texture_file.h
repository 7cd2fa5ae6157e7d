// Interprets the description of a picture file that OpenImageIO gives: channels, colours, windows
// and orientation.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/vec.h"
#include "render/scene/texture.h"

namespace psf::render {

// The channels that hold the colour. `alpha` is set only where the colour is premultiplied by it.
struct ColourChannels {
  std::size_t red = 0, green = 0, blue = 0;
  std::optional<std::size_t> alpha;
};

// Throws Error{bad_input} that names the file where it is not a plane picture of colours: for
// volumes, cube maps, and luminance with chroma.
void refuse_layout(const std::string& name, const OIIO::ImageSpec& spec);

// The channels R, G and B in the first layer that has channels of these names; else the first three
// channels, or the first for a grey picture.
[[nodiscard]] ColourChannels colour_channels(const std::string& name, const OIIO::ImageSpec& spec,
                                             TextureUse use, std::vector<std::string>& notes);

// The function from stored to linear values. Throws Error{bad_input} for a logarithmic scale.
[[nodiscard]] std::function<float(float)> transfer_curve(const std::string& name,
                                                         const OIIO::ImageSpec& spec,
                                                         TextureUse use, bool plain);

// The matrix, for row vectors, to the primaries and the white of Rec. 709; not set where the file
// has these already or does not say.
[[nodiscard]] std::optional<Imath::M33f> to_rec709(const OIIO::ImageSpec& spec);

// The places in the file of the texels of the picture as it is to be seen.
class TexelMap {
 public:
  // Throws Error{bad_input} where none of the data lies in the display window.
  TexelMap(const std::string& name, const OIIO::ImageSpec& spec);
  // The size of the picture as it is to be seen.
  [[nodiscard]] std::size_t width() const { return turned_ ? full_height_ : full_width_; }
  [[nodiscard]] std::size_t height() const { return turned_ ? full_width_ : full_height_; }
  // The index in the data of the texel in column x of row y; not set where the file has no such
  // texel.
  [[nodiscard]] std::optional<std::size_t> stored(std::size_t x, std::size_t y) const;

 private:
  std::size_t full_width_, full_height_;  // size of the display window
  std::size_t data_width_, data_height_;
  std::ptrdiff_t data_x_ = 0, data_y_ = 0;  // place of the data in the display window
  int orientation_;                         // orientation of EXIF, 1 to 8
  bool turned_;                             // width and height are exchanged
};

}  // namespace psf::render
