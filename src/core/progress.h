// Progress of long work on stderr: a bar on a terminal, a line now and then elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace psf::core {

// Not for use from several threads at once: call advance() between parallel steps.
class Progress {
 public:
  // `what`: a word or two, "render". `quiet`: say nothing.
  Progress(std::string what, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` of `total` steps; `note` is shown behind the bar, "3.1 M rays/s".
  void advance(std::uint64_t done, std::uint64_t total, const std::string& note = {});
  // Ends the bar's line; nothing is shown afterwards.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool quiet_, terminal_;
  bool shown_ = false;
  Clock::time_point start_, last_;
};

// 73 -> "1:13"
[[nodiscard]] std::string format_seconds(double seconds);

}  // namespace psf::core
