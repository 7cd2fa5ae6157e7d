// ^C sets a flag instead of ending the program, so that long work can end after a whole step.
#pragma once

#include <atomic>

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

// As long as it is there, interrupted() on its thread is also true once `stopped` is: the work of
// one thread ends and that of the others goes on. The innermost one counts. The thread that made it
// destroys it, the innermost first.
class Interruptible {
 public:
  explicit Interruptible(const std::atomic<bool>& stopped) noexcept;
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  const std::atomic<bool>* before_;
};

// Throws Error{interrupted} where the flag is set; `what`, the end of its message, says what is
// left behind.
void throw_if_interrupted(const char* what);

}  // namespace psf::core
