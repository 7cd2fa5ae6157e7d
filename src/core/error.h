// psf::Error for the folders that know nothing of formats.
#pragma once

#include "formats/error.h"  // IWYU pragma: export
