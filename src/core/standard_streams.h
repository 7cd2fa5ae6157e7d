// Standard output and standard error. Write errors of standard output are reported, because results
// must arrive; those of standard error are ignored.
#pragma once

#include <string_view>

namespace psf::core {

// Call this once, before any file is opened. Opens /dev/null for each of the three standard streams
// that is closed, so that no file of the program gets its number and then the program's text.
// Reading from or writing to such a stream fails.
void open_standard_streams();

// Throws Error{io}, for example "standard output: No space left on device", where printed text
// could not be written.
void flush_standard_output();

// Writes `text` to stderr as one line; control characters are escaped. Errors are ignored.
void say(std::string_view text) noexcept;

}  // namespace psf::core
