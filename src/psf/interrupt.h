// Ends long calls from another thread.
#pragma once

#include <atomic>
#include <memory>

#include "psf/export.h"

namespace psf {

// As long as it is there, calls of its thread throw Error{interrupted} at their next step once
// `stopped` is true, which any thread may say. The calls of other threads go on. The thread that
// made it destroys it, of several the last one first.
class PSF_API Interruptible {
 public:
  // Begins with the calls that this thread makes from now on; `stopped` is borrowed.
  explicit Interruptible(const std::atomic<bool>& stopped);
  ~Interruptible();  // The thread's calls end as before.
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Every call that is at work, and every later one, throws Error{interrupted} at its next step,
// until clear_interrupt().
PSF_API void interrupt() noexcept;
// Lets calls run again.
PSF_API void clear_interrupt() noexcept;

}  // namespace psf
