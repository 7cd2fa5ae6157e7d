// Whether the pixels and cameras of records exist.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "filter/records.h"

namespace psf::filter {

// The most pixels of all cameras together: a damaged size must not become an allocation.
inline constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 32;

// The number of the first record whose camera or pixel does not exist; on all threads.
[[nodiscard]] std::optional<std::size_t> first_misplaced(std::span<const std::uint32_t> pixel,
                                                         std::span<const std::uint16_t> camera,
                                                         std::span<const CameraView> cameras);

}  // namespace psf::filter
