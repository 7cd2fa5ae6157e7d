// Whether what an EXR declares of itself can be true, before anything is done for it.
#pragma once

#include <ImfForward.h>

#include <string>

namespace psf::film {

// Reads the headers alone. After it the work of opening the file, in bytes, is bounded by a
// multiple of its length. Throws Error{io} where it cannot be read, Error{bad_input} for a file
// that is no EXR, is cut short or damaged; of a file of one part, what check_part() throws.
void check_exr(const std::string& path);

// After this, too, the work of reading the part is bounded by a multiple of the file's length, or
// by `kMostPixels` where its compression has no bound; what other parts hold does not matter.
// Throws Error{bad_input} where the part is damaged or has deep pixels, Error{limit} for more than
// kMostPixels.
void check_part(const std::string& path, const Imf::Header& part);

// What OpenEXR or a file says, as one line: control characters become spaces.
[[nodiscard]] std::string one_line(std::string text);

inline constexpr long long kMostPixels = 1LL << 29;  // of the data window, or the display window

}  // namespace psf::film
