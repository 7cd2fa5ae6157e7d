// Puts the index of a file together: README.md, "Opening", steps 5 and 6.
#pragma once

#include "formats/layout/file.h"
#include "formats/read/open.h"

namespace psf::formats {

// Sets chunks and root of `opened`, whose last commit is known. Throws Error{bad_input} that names
// the file and what is missing.
void load_index(const File& file, Opened& opened);

}  // namespace psf::formats
