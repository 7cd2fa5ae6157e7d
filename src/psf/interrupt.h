// Ends long calls from another thread.
#pragma once

#include "psf/export.h"

namespace psf {

// Every call that is at work, and every later one, throws Error{interrupted} at its next block,
// until clear_interrupt().
PSF_API void interrupt() noexcept;
PSF_API void clear_interrupt() noexcept;

}  // namespace psf
