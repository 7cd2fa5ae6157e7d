// ^C: noticed, not obeyed at once, so that long work can end at a whole step.
#pragma once

namespace psf::core {

// From now on SIGINT, SIGTERM, SIGHUP and SIGXCPU set a flag. A second one ends the program at once
// with exit code 130 (SIGXCPU comes every second and does not), and what is unfinished is removed;
// so it is, too, where another signal ends it. A write beyond the limit of file sizes and one into
// a closed pipe fail and end nothing (SIGXFSZ, SIGPIPE).
void watch_interrupts();
[[nodiscard]] bool interrupted() noexcept;
// Throws Error{interrupted} where the flag is set; `what` says what is left behind.
void throw_if_interrupted(const char* what);

}  // namespace psf::core
