// Checks that the sizes which an EXR declares can be true, before memory or time is spent on it.
#pragma once

#include <ImfForward.h>

#include <string>

namespace psf::film {

// Reads the headers alone. After this check the bytes that opening the file takes are bounded by a
// multiple of the file's length. Throws Error{io} where the file cannot be read, Error{bad_input}
// where it is no EXR, cut short or damaged, and, for a file of one part, what check_part() throws.
void check_exr(const std::string& path);

// Checks the part that is to be read; the other parts do not matter. After this check the work of
// reading it is bounded by a multiple of the file's length, or by kMostPixels where its compression
// has no bound. Throws Error{bad_input} where the part is damaged or has deep pixels, Error{limit}
// where it has more than kMostPixels or is nearly all margin.
void check_part(const std::string& path, const Imf::Header& part);

// `text`, from OpenEXR or a file, as one line: control characters become spaces.
[[nodiscard]] std::string one_line(std::string text);

inline constexpr long long kMostPixels = 1LL << 29;  // in the data window and the display window

}  // namespace psf::film
