// psf::Unfinished for the folders that know nothing of formats.
#pragma once

#include "formats/unfinished.h"  // IWYU pragma: export

namespace psf::core {
using psf::Unfinished;
}  // namespace psf::core
