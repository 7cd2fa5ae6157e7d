// How long something took, by a steady clock.
#pragma once

#include <chrono>

namespace psf::core {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace psf::core
