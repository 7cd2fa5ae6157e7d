// Where the coordinates of a scene lie in the world.
#pragma once

#include "core/vec.h"

namespace psf::render {

// Floats have 24 bits: a scene far from the origin would lose those that tell its parts apart, and
// squares of what is huge or tiny are no floats. So such a scene is loaded around a place of its
// own and in a unit of its own, a power of two of the world's. Cameras see the same pictures as
// ever, and a dump has world units again. An ordinary scene's space is the world.
struct Space {
  Imath::V3d origin{0, 0, 0};  // in the world
  int exponent = 0;            // a length of 1 here is 2^exponent in the world
  // Loaders place everything in double and round once. Otherwise they calculate in float, as they
  // may where the space is the world.
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

  // Of row vectors, p * m.
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
