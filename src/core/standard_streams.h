// Standard output is checked, standard error is not: results must arrive, remarks need not.
#pragma once

#include <string_view>

namespace psf::core {

// Once, before any file is opened: one of the three that is closed would give its number to a file
// of ours, which would then get the program's text. What is written to it fails instead.
void open_standard_streams();

// Throws Error{io} "standard output: No space left on device" where what was printed did not get
// out.
void flush_standard_output();

// A line on stderr; what does not print in `text` is escaped, so that it is one. Nothing where it
// cannot be written: no work ends for it.
void say(std::string_view text) noexcept;

}  // namespace psf::core
