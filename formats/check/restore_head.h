// Restores HEAD of a file whose first frame is unreadable from the copies in its commits.
#pragma once

#include <cstdint>
#include <optional>

#include "formats/layout/file.h"
#include "formats/read/open.h"

namespace psf::formats {

// The copy of the first commit that has a whole one, whatever its uuid; not set where no commit has
// one. Throws only Error{io}.
[[nodiscard]] std::optional<HeadFrame> restore_head(const File& file, std::uint64_t file_size);

}  // namespace psf::formats
