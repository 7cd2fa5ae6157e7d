// The first half of a check: compares what the frames say of each other.
#pragma once

#include <cstdint>

#include "formats/check.h"
#include "formats/file.h"
#include "formats/walk.h"

namespace psf::formats {

// Adds to the report all but columns and the padding around them, and to the walk the chunks that
// only an index knows.
void check_frames(const File& file, Walk& walk, CheckReport& report);

// Adds a fault where bytes [from, to) of the frame are not all zero.
void check_zeros(const File& file, const Prefix& frame, std::uint64_t from, std::uint64_t to,
                 CheckReport& report);

}  // namespace psf::formats
