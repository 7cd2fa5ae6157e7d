#include "psf/interrupt.h"

#include "core/interrupt.h"

namespace psf {

struct Interruptible::State : core::Interruptible {
  using core::Interruptible::Interruptible;
};

Interruptible::Interruptible(const std::atomic<bool>& stopped)
    : state_(std::make_unique<State>(stopped)) {}
Interruptible::~Interruptible() = default;

void interrupt() noexcept {
  core::interrupt();
}

void clear_interrupt() noexcept {
  core::clear_interrupt();
}

}  // namespace psf
