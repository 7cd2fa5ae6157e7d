#include "core/interrupt.h"

#include <atomic>
#include <csignal>
#include <string>

#include "core/error.h"

namespace psf::core {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler needs a lock-free flag");

void note(int signal) {
  flag = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void watch_interrupts() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
}

bool interrupted() noexcept {
  return flag;
}

void throw_if_interrupted(const char* what) {
  if (interrupted()) throw Error(ErrorCode::interrupted, std::string("interrupted: ") + what);
}

}  // namespace psf::core
