// ^C sets a flag instead of ending the program, so that long work can end after a whole step.
#pragma once

#include <atomic>
#include <cstdint>

namespace psf::core {

// After this call SIGINT, SIGTERM, SIGHUP and SIGXCPU set a flag. A second signal removes the
// unfinished files and ends the program at once with exit code 130, except SIGXCPU, which comes
// every second. Unfinished files are also removed where another signal ends the program. A write
// beyond the file size limit or into a closed pipe fails without ending the program (SIGXFSZ and
// SIGPIPE are ignored).
void watch_interrupts();
[[nodiscard]] bool interrupted() noexcept;
// Whether that has been so for a second: a step that is not yet whole is then to be dropped.
[[nodiscard]] bool overdue() noexcept;
// Sets the flag as a signal would, and takes it back, for programs with handlers of their own.
void interrupt() noexcept;
void clear_interrupt() noexcept;

// As long as it is there, interrupted() on its thread is also true once `stopped` is: the work of
// one thread ends and that of the others goes on. The innermost one counts. The thread that made it
// destroys it, the innermost first. Bodies of parallel_for() have that of its caller.
class Interruptible {
 public:
  explicit Interruptible(const std::atomic<bool>& stopped) noexcept;
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  // Those of this thread; null: none.
  [[nodiscard]] static const Interruptible* here() noexcept;
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  [[nodiscard]] bool overdue() const noexcept;

 private:
  const std::atomic<bool>& stopped_;
  mutable std::atomic<std::int64_t> seen_{0};  // when overdue() first found it stopped
  const Interruptible* before_;
};

// As long as it is there, what is Interruptible::here() on another thread is so on this one.
class WorkFor {
 public:
  explicit WorkFor(const Interruptible* other) noexcept;
  ~WorkFor();
  WorkFor(const WorkFor&) = delete;
  WorkFor& operator=(const WorkFor&) = delete;

 private:
  const Interruptible* before_;
};

// Throws Error{interrupted} where the flag is set; `what`, the end of its message, says what is
// left behind.
void throw_if_interrupted(const char* what);

}  // namespace psf::core
