// Reads the colours of an EXR of any program, and where they lie, to compare them with others.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/vec.h"

namespace psf::film {

// The display window of a file. Pixels of it that are outside the data window are black (OpenEXR's
// technical introduction calls them transparent); pixels outside the display window are left out.
struct Picture {
  std::string path;
  std::string layer;  // name of the layer that was read; empty: the root
  std::size_t width = 0, height = 0;
  int left = 0, top = 0;    // corner of the display window, pixels
  std::vector<Rgb> colors;  // (height, width), row 0 at the top
  std::string environment;  // "latlong" or "cube"; empty: a camera's picture
  // x, y of red, green, blue and white; Rec. 709 unless the file says otherwise.
  std::array<float, 8> primaries = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
  std::vector<std::string> notes;  // remarks for the user, a line each, with the path
};

struct PictureRequest {
  std::string layer;                  // `name` of choose_layer(); empty: the only or the root layer
  std::string fallback;               // layer to take where several would do
  std::string parameter = "`layer`";  // what names the layer, in messages
};

// Reads scan lines, tiles (the full picture of a mipmap), one part of several, float, half and
// whole numbers, and luminance-chroma. Colours are premultiplied, as EXR stores them;
// the background that a picture of ours keeps apart (light_layers.h) is added to them. Throws what
// check_exr(), check_part() and choose_layer() throw, and Error{bad_input} where the file is
// damaged or incomplete or has what is not supported: subsampled colours, an orientation, or
// colours that are not linear.
[[nodiscard]] Picture read_picture(const std::string& path, const PictureRequest& request = {});

// Checks that equal pixels of the two pictures show the same place: throws Error{bad_input} where
// size, place or projection differ. Returns a note where their primaries differ, else "".
[[nodiscard]] std::string check_comparable(const Picture& picture, const Picture& reference);

}  // namespace psf::film
