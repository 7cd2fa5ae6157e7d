// ^C sets a flag instead of ending the program, so that long work can end after a whole step.
#pragma once

namespace psf::core {

// After this call SIGINT, SIGTERM, SIGHUP and SIGXCPU set a flag. A second signal removes the
// unfinished files and ends the program at once with exit code 130, except SIGXCPU, which comes
// every second. Unfinished files are also removed where another signal ends the program. A write
// beyond the file size limit or into a closed pipe fails without ending the program (SIGXFSZ and
// SIGPIPE are ignored).
void watch_interrupts();
[[nodiscard]] bool interrupted() noexcept;
// Sets the flag as a signal would, and takes it back, for programs with handlers of their own.
void interrupt() noexcept;
void clear_interrupt() noexcept;
// Throws Error{interrupted} where the flag is set; `what`, the end of its message, says what is
// left behind.
void throw_if_interrupted(const char* what);

}  // namespace psf::core
