// A texture: linear RGB, bilinear, repeating. Files are read by OpenImageIO.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"

namespace psf::render {

// The use of a picture, which decides the values that it may have. Colours of integer files are
// sRGB unless the file says otherwise; those of float files are linear.
enum class TextureUse {
  reflectance,  // colours in [0, 1]
  numbers,      // as stored, in [0, 1]
  relief,       // tangent-space normals, so stored; a grey picture is of heights, and becomes those
  alpha,        // the alpha channel as grey numbers; 1 where there is none
  opacity,      // the same; where there is no alpha, the luminance of the numbers as stored
  radiance      // colours of at least 0; premultiplied colours stay premultiplied
};

// 8-bit files stay 8-bit in memory (4 bytes per texel); each lookup makes them linear by a table.
// All other files become 32-bit float.
class Texture {
 public:
  // (height, width) colours, row 0 at v = 1 (the top of the picture).
  Texture(std::size_t width, std::size_t height, std::vector<Rgb> texels);

  // Loads a picture file. It honours the file's orientation, gamma, chromaticities, display window
  // (black around the data) and premultiplied alpha; with `plain` colours are sRGB whatever the
  // file says, as glTF demands. Alpha itself is ignored, and grey becomes RGB. Values out of range
  // are clamped. `notes` gets a line about that, and lines about what else of the file is left out;
  // each starts with the file's name. Throws Error{io} where the file is missing, Error{bad_input}
  // where it is no picture, a cube map, logarithmic or not finite, Error{limit} where it has more
  // than 2^28 texels; all errors name the file.
  static Texture load(const std::string& path, TextureUse use, std::vector<std::string>& notes,
                      bool plain = false);
  // The same for the bytes of a picture file; messages call them `name`.
  static Texture decode(std::span<const unsigned char> bytes, const std::string& name,
                        TextureUse use, std::vector<std::string>& notes, bool plain = false);
  // The reason why no reader is available for the picture `path`, or for `bytes` where they are
  // given; empty where there is a reader.
  static std::string why_unreadable(const std::string& path,
                                    std::span<const unsigned char> bytes = {});

  // The tangent-space normals, x along u and y along v, of heights whose white is above black by
  // the width of a texel.
  [[nodiscard]] Texture normals_of_heights() const;
  // Whether its colours differ so little that it is no picture of colours.
  [[nodiscard]] bool grey() const;

  [[nodiscard]] Rgb at(const Vec2& uv) const;  // u to the right, v up
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  [[nodiscard]] Rgb texel(std::size_t x, std::size_t y) const {
    const std::size_t i = y * width_ + x;
    if (packed_.empty()) return texels_[i];
    const std::uint32_t p = packed_[i];
    return {(*table_)[p & 255], (*table_)[(p >> 8) & 255], (*table_)[(p >> 16) & 255]};
  }

 private:
  using Table = std::array<float, 256>;
  Texture(std::size_t width, std::size_t height) : width_(width), height_(height) {}
  static Texture read(const std::string& name, std::span<const unsigned char> bytes, TextureUse use,
                      std::vector<std::string>& notes, bool plain);

  std::size_t width_, height_;
  std::vector<std::uint32_t> packed_;   // 8-bit texels, red in the low byte; or empty
  std::shared_ptr<const Table> table_;  // the linear value of a byte of packed_
  std::vector<Rgb> texels_;             // float texels; empty where packed_ is not
};

// The sRGB transfer function of IEC 61966-2-1, from encoded to linear, both in [0, 1].
[[nodiscard]] inline float srgb_to_linear(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace psf::render
