// Colour maps of false-colour pictures.
//
// inferno, magma, plasma and viridis are those of matplotlib (van der Walt and Smith 2015, CC0),
// turbo is Mikhailov's (2019, Apache 2.0).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace psf::metrics {

inline constexpr const char* kColorMaps[] = {"inferno", "magma", "plasma", "viridis", "turbo"};

// The colour of `value`, clamped to [0, 1], as 8-bit sRGB. It is the map's own colour at multiples
// of 1/16, and linear between them. Throws Error{usage} for a name that is not in kColorMaps.
[[nodiscard]] std::array<std::uint8_t, 3> mapped_color(std::string_view map, double value);

}  // namespace psf::metrics
