// [fireflies]: whether the bright contributions around one lie as evenly as all others do. Then they
// are how the light is there, and no average knows better than a mean over the ball.
#pragma once

#include <cstdint>

#include "core/vec.h"

namespace psf::filter {

// How far around record j evenness is looked for, in r_j.
inline constexpr float kEvenRadius = 2;

// Gathers the places of records around x_j. No sum depends on their order: places are whole steps.
class Evenness {
 public:
  // `radius`: kEvenRadius r_j; may be infinite.
  explicit Evenness(float radius) : steps_(kSteps / radius) {}

  // `offset`: x_k - x_j, at most as long as the radius.
  void add(const Vec3& offset, bool is_bright);

  // T_j < 12. Not where T_j is undefined, since no two places differ.
  [[nodiscard]] bool is_even() const;

 private:
  static constexpr float kSteps = 1 << 15;  // of squares of their squares 2^33 have room

  // Of places o, in the radius, and of u = |o|^2.
  struct Moments {
    std::int64_t count = 0, o[3] = {}, u = 0, u_sq = 0;

    [[nodiscard]] double mean(std::int64_t sum) const {
      return static_cast<double>(sum) / (double{kSteps} * static_cast<double>(count));
    }
  };

  float steps_;
  Moments all_, bright_;
};

}  // namespace psf::filter
