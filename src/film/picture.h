// The colours of anyone's EXR, where they lie, to be compared with others.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/vec.h"

namespace psf::film {

// The display window of a file. Pixels outside its data window are black, as OpenEXR's technical
// introduction has transparent ones; pixels outside the display window are left out.
struct Picture {
  std::string path;
  std::string layer;  // that was read; empty: the root
  std::size_t width = 0, height = 0;
  int left = 0, top = 0;    // of the display window
  std::vector<Rgb> colors;  // (height, width), row 0 at the top
  std::string environment;  // "latlong", "cube", or empty: a camera's picture
  // x, y of red, green, blue and white; Rec. 709 unless the file says otherwise.
  std::array<float, 8> primaries = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
  std::vector<std::string> notes;  // what a user should know, a line each, with the path
};

struct PictureRequest {
  std::string layer;               // as in exr_layers.h; empty: the one there is
  std::string fallback;            // taken where several would do
  std::string option = "--layer";  // that names a layer, for messages
};

// Reads scan lines, tiles (of a mipmap the whole picture), one part of several, float, half and
// whole numbers, and luminance-chroma. Colours are premultiplied, as EXR has them. Throws what
// check_exr(), check_part() and choose_layer() throw; Error{bad_input} for a file that is damaged
// or incomplete and for what is not honoured: subsampled colours, an orientation, colours that are
// not linear.
[[nodiscard]] Picture read_picture(const std::string& path, const PictureRequest& request = {});

// Whether pixels of the two show the same place: throws Error{bad_input} where size, place or
// projection differ. A note where their primaries do; empty: none.
[[nodiscard]] std::string check_comparable(const Picture& picture, const Picture& reference);

}  // namespace psf::film
