#include "core/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace psf::core {
namespace {
constexpr double kTerminalInterval = 0.1;  // seconds between two drawings of the bar
constexpr double kLogInterval = 10;        // seconds between two lines where stderr is no terminal

// {fmt} would throw where stderr takes no more.
void show(const std::string& text) {
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
  static_cast<void>(std::fflush(stderr));
}

}  // namespace

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() {
  finish();
}

void Progress::advance(std::uint64_t done, std::uint64_t total, const std::string& note) {
  if (quiet_ || total == 0) return;
  const auto now = Clock::now();
  const std::chrono::duration<double> since_last = now - last_;
  const double interval = terminal_ ? kTerminalInterval : kLogInterval;
  if (since_last.count() < interval && !(done == total && shown_)) return;
  last_ = now;
  shown_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double fraction = static_cast<double>(done) / static_cast<double>(total);
  const std::string left =
      done == 0 ? "" : format_seconds(elapsed * (1 - fraction) / fraction) + " left";
  const std::string separator = note.empty() ? "" : ", ";
  if (terminal_) {
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(std::lround(fraction * kWidth));
    show(fmt::format("\r{} [{:#<{}}{:.<{}}] {:3.0f}%  {}{}{}\033[K", what_, "", filled, "",
                     kWidth - filled, 100 * fraction, note, separator, left));
  } else {
    show(fmt::format("{} {:.0f}%  {}{}{}\n", what_, 100 * fraction, note, separator, left));
  }
}

void Progress::finish() {
  if (shown_ && terminal_) show("\n");
  shown_ = false;
  quiet_ = true;
}

std::string format_seconds(double seconds) {
  const auto whole = static_cast<long>(std::lround(std::max(0.0, seconds)));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace psf::core
