#include "formats/layout/quantize.h"

#include <half.h>

#include <cmath>
#include <cstddef>
#include <limits>

namespace psf::formats {
namespace {

// Codes 0 to 65534, so that 32767 is exactly 0 and the axes are exact; 65535 marks what is no
// direction.
constexpr float kScale = 32767.0f;
constexpr std::uint16_t kMark = 65535;

std::uint16_t quantize(float value) {
  return static_cast<std::uint16_t>(std::lround((value + 1.0f) * kScale));
}

float one_with_sign_of(float value) {
  return value < 0 ? -1.0f : 1.0f;
}

}  // namespace

void encode_octahedral(std::span<const float> vectors, std::span<std::uint16_t> codes) {
  for (std::size_t k = 0; 2 * k + 1 < codes.size(); ++k) {
    const float x = vectors[3 * k], y = vectors[3 * k + 1], z = vectors[3 * k + 2];
    const float sum = std::abs(x) + std::abs(y) + std::abs(z);
    std::uint16_t* const code = &codes[2 * k];
    if (!std::isfinite(sum) || sum == 0) {
      code[0] = kMark;
      code[1] = sum == 0 ? kMark : 0;
      continue;
    }
    float u = x / sum, v = y / sum;
    if (z < 0) {
      const float folded = (1 - std::abs(v)) * one_with_sign_of(u);
      v = (1 - std::abs(u)) * one_with_sign_of(v);
      u = folded;
    }
    code[0] = quantize(u);
    code[1] = quantize(v);
  }
}

void decode_octahedral(std::span<const std::uint16_t> codes, std::span<float> vectors) {
  for (std::size_t k = 0; 2 * k + 1 < codes.size(); ++k) {
    const std::uint16_t* const code = &codes[2 * k];
    float* const out = &vectors[3 * k];
    if (code[0] == kMark || code[1] == kMark) {
      const bool zero = code[0] == kMark && code[1] == kMark;
      out[0] = out[1] = out[2] = zero ? 0 : std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    float x = (static_cast<float>(code[0]) - kScale) / kScale;
    float y = (static_cast<float>(code[1]) - kScale) / kScale;
    const float z = 1 - std::abs(x) - std::abs(y);
    if (z < 0) {
      const float unfolded = (1 - std::abs(y)) * one_with_sign_of(x);
      y = (1 - std::abs(x)) * one_with_sign_of(y);
      x = unfolded;
    }
    const float length = std::sqrt(x * x + y * y + z * z);
    out[0] = x / length;
    out[1] = y / length;
    out[2] = z / length;
  }
}

void encode_half(std::span<const float> values, std::span<std::uint16_t> halves) {
  for (std::size_t k = 0; k < values.size(); ++k) halves[k] = imath_float_to_half(values[k]);
}

void decode_half(std::span<const std::uint16_t> halves, std::span<float> values) {
  for (std::size_t k = 0; k < halves.size(); ++k) values[k] = imath_half_to_float(halves[k]);
}

}  // namespace psf::formats
