// A picture as text in a page: half floats, predicted, deflated, base64.
#pragma once

#include <cstddef>
#include <string>

#include "film/image.h"

namespace psf::study {

struct EncodedPicture {
  std::size_t width = 0, height = 0;
  std::string base64;
};

// R, G, B as half floats, finite values beyond the largest half held to it. The planes R, G, B
// follow each other; each value is the difference (modulo 2^16) to its left neighbour, in the first
// column to the one above, 0 for the first; all low bytes, then all high bytes; deflated with
// zlib's header. Throws Error{bad_input} where a channel is missing.
[[nodiscard]] EncodedPicture encode_picture(const film::Image& image);

}  // namespace psf::study
