// Which passes of a dump a call takes.
#pragma once

#include <cstdint>
#include <optional>

namespace psf {

// Which passes, counted from 0: [first, last).
struct Passes {
  std::uint64_t first = 0;                 // the first one
  std::optional<std::uint64_t> last = {};  // the one behind the last; not set: all there are
};

}  // namespace psf
