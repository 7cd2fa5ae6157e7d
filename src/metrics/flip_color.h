// The colour spaces of FLIP, all relative to the white point, which cancels.
#pragma once

#include <ImathMatrix.h>

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace psf::metrics {

// Linear sRGB to X / Xn, Y / Yn, Z / Zn: rows of the primaries' matrix, each divided by its sum.
class FlipColor {
 public:
  // Linear sRGB to Y, Cx, Cz. These are linear in the colour, as the filters need.
  [[nodiscard]] Vec3 opponent(const Vec3& linear) const {
    const Vec3 v = linear * to_white_;
    return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
  }
  // Y, Cx, Cz back to linear sRGB, clamped to [0, 1].
  [[nodiscard]] Vec3 linear(const Vec3& opponent) const {
    const float y = (opponent.x + 16) / 116;
    const Vec3 v = Vec3(y + opponent.y / 500, y, y - opponent.z / 200) * from_white_;
    return {std::clamp(v.x, 0.0f, 1.0f), std::clamp(v.y, 0.0f, 1.0f), std::clamp(v.z, 0.0f, 1.0f)};
  }
  // Linear sRGB to L*, a* and b*, where a* and b* are multiplied by L* / 100, since dark colours
  // look less colourful (Hunt).
  [[nodiscard]] Vec3 hunt_lab(const Vec3& linear) const {
    const Vec3 v = linear * to_white_;
    const float x = root(v.x), y = root(v.y), z = root(v.z);
    const float lightness = 116 * y - 16;
    return {lightness, 0.01f * lightness * 500 * (x - y), 0.01f * lightness * 200 * (y - z)};
  }

 private:
  static float root(float t) {
    constexpr float kDelta = 6.0f / 29;
    return t > kDelta * kDelta * kDelta ? std::pow(t, 1.0f / 3)
                                        : t / (3 * kDelta * kDelta) + 4.0f / 29;
  }
  // Imath multiplies rows from the left, so the matrix stands transposed.
  static Imath::M33d matrix() {
    constexpr double kX = 23359437, kY = 12288897, kZ = 80288307;
    return {10135552 / kX, 2613072 / kY, 1425312 / kZ, 8788810 / kX, 8788810 / kY,
            8788810 / kZ,  4435075 / kX, 887015 / kY,  70074185 / kZ};
  }

  Imath::M33f to_white_{matrix()}, from_white_{matrix().inverse()};
};

// The distance HyAB of two colours: city-block in lightness, Euclidean in a* and b* (Abasi 2020).
[[nodiscard]] inline float hyab(const Vec3& a, const Vec3& b) {
  const Vec3 d = a - b;
  return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

}  // namespace psf::metrics
