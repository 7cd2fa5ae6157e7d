#include "core/interrupt.h"

#include <time.h>  // NOLINT: clock_gettime is POSIX
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <string>

#include "core/error.h"
#include "core/unfinished.h"

namespace psf::core {
namespace {

// timeout(1) sends its signal twice, to the program and to its group, within microseconds.
constexpr std::int64_t kOneSignal = 50'000'000;  // nanoseconds

// How long a step may take to become whole.
constexpr std::int64_t kPatience = 1'000'000'000;  // nanoseconds

thread_local const Interruptible* innermost = nullptr;

std::atomic<std::int64_t> first{0};  // time of the first signal; 0: none
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a handler needs a lock-free flag");

std::int64_t now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

bool is_first() {
  std::int64_t none = 0;
  return first.compare_exchange_strong(none, now());
}

void note(int) {
  if (is_first() || now() - first < kOneSignal) return;
  remove_unfinished();
  _exit(static_cast<int>(ErrorCode::interrupted));
}

void note_only(int) {
  static_cast<void>(is_first());
}

// The disposition is the default one again: once the handler is left the signal does what it does.
void end(int signal) {
  remove_unfinished();
  static_cast<void>(std::raise(signal));
}

void handle(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

}  // namespace

void watch_interrupts() {
  handle(SIGINT, note, SA_RESTART);
  handle(SIGTERM, note, SA_RESTART);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) handle(SIGHUP, note, SA_RESTART);  // nohup ignores it
  handle(SIGXCPU, note_only, SA_RESTART);
  handle(SIGXFSZ, SIG_IGN, 0);
  handle(SIGPIPE, SIG_IGN, 0);
  for (const int signal : {SIGQUIT, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGALRM,
                           SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2}) {
    sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_DFL) handle(signal, end, static_cast<int>(SA_RESETHAND));
  }
}

void interrupt() noexcept {
  static_cast<void>(is_first());
}

void clear_interrupt() noexcept {
  first = 0;
}

bool interrupted() noexcept {
  return first != 0 || (innermost != nullptr && innermost->stopped());
}

bool overdue() noexcept {
  const std::int64_t since = first;
  return (since != 0 && now() - since > kPatience) ||
         (innermost != nullptr && innermost->overdue());
}

Interruptible::Interruptible(const std::atomic<bool>& stopped) noexcept
    : stopped_(stopped), before_(innermost) {
  innermost = this;
}

Interruptible::~Interruptible() {
  innermost = before_;
}

const Interruptible* Interruptible::here() noexcept {
  return innermost;
}

bool Interruptible::overdue() const noexcept {
  if (!stopped_) return false;
  const std::int64_t moment = now();
  std::int64_t seen = 0;
  if (seen_.compare_exchange_strong(seen, moment)) seen = moment;
  return moment - seen > kPatience;
}

WorkFor::WorkFor(const Interruptible* other) noexcept : before_(innermost) {
  innermost = other;
}

WorkFor::~WorkFor() {
  innermost = before_;
}

void throw_if_interrupted(const char* what) {
  if (interrupted()) throw Error(ErrorCode::interrupted, std::string("interrupted: ") + what);
}

}  // namespace psf::core
