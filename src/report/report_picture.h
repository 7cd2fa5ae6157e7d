// A picture as text in a page: half floats, predicted, deflated, base64.
#pragma once

#include <cstddef>
#include <string>

#include "film/image.h"

namespace psf::report {

struct EncodedPicture {
  std::size_t width = 0, height = 0;
  std::string base64;
};

// Encodes R, G, B as half floats; finite values beyond the largest half are clamped to it. The
// planes R, G, B follow each other. Each value is stored as the difference (modulo 2^16) to its
// left neighbour, in the first column to the value above, and to 0 for the first value. All low
// bytes come first, then all high bytes; they are deflated with zlib's header. Throws
// Error{bad_input} where a channel is missing.
[[nodiscard]] EncodedPicture encode_picture(const film::Image& image);

}  // namespace psf::report
