// Whether what an EXR declares of itself can be true, before anything is done for it.
#pragma once

#include <string>

namespace psf::film {

// Reads the headers alone. After it the work of opening and reading the file, in bytes, is bounded
// by a multiple of the file's length, or by `kMostPixels` where its compression has no bound.
// Throws Error{io} where it cannot be read, Error{bad_input} for a file that is no EXR, is cut
// short or damaged, holds deep pixels, or none, Error{limit} for more than kMostPixels.
void check_exr(const std::string& path);

// What OpenEXR or a file says, as one line: control characters become spaces.
[[nodiscard]] std::string one_line(std::string text);

inline constexpr long long kMostPixels = 1LL << 29;  // of the data window, or the display window

}  // namespace psf::film
