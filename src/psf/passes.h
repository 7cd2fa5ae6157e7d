// Which passes of a dump a call takes.
#pragma once

#include <cstdint>
#include <optional>

namespace psf {

// From 0: [first, last); `last` not set: all there are.
struct Passes {
  std::uint64_t first = 0;
  std::optional<std::uint64_t> last = {};
};

}  // namespace psf
