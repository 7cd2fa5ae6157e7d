// The coordinate system of a scene and its place in the world.
#pragma once

#include "core/vec.h"

namespace psf::render {

// In a scene's space: the square of a length, times a length as small, is a float with all digits.
constexpr float kLeastLength = 0x1p-32f;

// Floats have 24 bits. In a scene far from the origin they could not tell the scene's parts apart,
// and the squares of huge or tiny lengths do not fit in floats. So such a scene is loaded around an
// origin of its own and in a unit of its own, the world's unit times a power of two. Pictures are
// the same, and a dump is in world units. The space of an ordinary scene is the world.
struct Space {
  Imath::V3d origin{0, 0, 0};  // in world coordinates
  int exponent = 0;            // a length of 1 in this space is 2^exponent in the world
  // Whether loaders compute places in double and round once. Otherwise they compute in float, which
  // is enough where the space is the world.
  bool exact = false;

  bool operator==(const Space&) const = default;
  [[nodiscard]] bool is_world() const { return *this == Space{{0, 0, 0}, 0, exact}; }

  [[nodiscard]] Vec3 local(const Imath::V3d& world) const {
    return Vec3((world - origin) * std::ldexp(1.0, -exponent));
  }
  [[nodiscard]] Imath::V3d world(const Vec3& local) const {
    return origin + Imath::V3d(local) * std::ldexp(1.0, exponent);
  }
  [[nodiscard]] float local_length(double world) const {
    return static_cast<float>(std::ldexp(world, -exponent));
  }
  [[nodiscard]] float world_length(float local) const { return std::ldexp(local, exponent); }

  // The matrices are for row vectors, p * m.
  [[nodiscard]] Imath::M44d to_local() const {
    Imath::M44d m;
    m.setTranslation(Imath::V3d(0, 0, 0) - origin);  // no -0, which would change bytes
    return m * Imath::M44d().setScale(std::ldexp(1.0, -exponent));
  }
  [[nodiscard]] Imath::M44d to_world() const {
    Imath::M44d m;
    m.setScale(std::ldexp(1.0, exponent));
    return m * Imath::M44d().setTranslation(origin);
  }
};

}  // namespace psf::render
