// Asks Embree what the renderer asked it, and nothing else: how fast rays can be at all.
#pragma once

#include <cstdint>
#include <span>

#include "render/accel/accel.h"

namespace psf::render {

// One ray after the other, as they were recorded. Returns how many met something.
[[nodiscard]] std::uint64_t replay(const Accel& accel, std::span<const RecordedRay> rays);

// The same for rays that ask what they meet, `width` at a time: 8 or 16, and the same distance and
// direction of all of them make it fast.
[[nodiscard]] std::uint64_t replay_packets(const Accel& accel, std::span<const RecordedRay> rays,
                                           std::size_t width);

}  // namespace psf::render
