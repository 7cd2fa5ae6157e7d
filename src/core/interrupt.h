// ^C: noticed, not obeyed at once, so that long work can end at a whole step.
#pragma once

namespace psf::core {

// From now on SIGINT and SIGTERM set a flag; a second one ends the program at once.
void watch_interrupts();
[[nodiscard]] bool interrupted() noexcept;
// Throws Error{interrupted} where the flag is set; `what` says what is left behind.
void throw_if_interrupted(const char* what);

}  // namespace psf::core
