// The first half of a check: compares the frames with what other frames say of them.
#pragma once

#include <cstdint>

#include "formats/check/check.h"
#include "formats/check/walk.h"
#include "formats/layout/file.h"

namespace psf::formats {

// Adds the results to the report, except those about columns and the padding around them. Adds to
// the walk the chunks that only an index names.
void check_frames(const File& file, Walk& walk, CheckResult& report);

// Adds a fault where bytes [from, to) of the frame are not all zero.
void check_zeros(const File& file, const Prefix& frame, std::uint64_t from, std::uint64_t to,
                 CheckResult& report);

}  // namespace psf::formats
