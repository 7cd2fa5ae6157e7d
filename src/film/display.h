// From linear radiance to what a screen shows.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace psf::film {

// Linear up to kShoulder; above it an exponential that reaches 1 at infinity, with the same slope
// where the two meet. Mid-tones stay true and lamps do not burn out. NaN and negative values give
// 0.
[[nodiscard]] inline float tone_map(float linear) {
  constexpr float kShoulder = 0.7f;
  if (!(linear > 0)) return 0;
  if (linear < kShoulder) return linear;
  return 1 - (1 - kShoulder) * std::exp(-(linear - kShoulder) / (1 - kShoulder));
}

// The sRGB transfer function of IEC 61966-2-1; `linear` is clamped to [0, 1].
[[nodiscard]] inline float srgb_from_linear(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

// The byte of a picture of 8 bits that shows it.
[[nodiscard]] inline std::uint8_t displayed_byte(float linear) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(tone_map(linear))));
}

}  // namespace psf::film
