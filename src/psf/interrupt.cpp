#include "psf/interrupt.h"

#include "core/interrupt.h"

namespace psf {

void interrupt() noexcept {
  core::interrupt();
}

void clear_interrupt() noexcept {
  core::clear_interrupt();
}

}  // namespace psf
