// Surfaces that are there only in part: alpha masks and blending, as what is met by rays.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/vec.h"
#include "render/accel/accel.h"
#include "render/light/surface.h"
#include "render/scene/scene.h"

namespace psf::render {

class Sampler;

// The opacity of one material.
struct Opacity {
  float factor = 1;
  const Texture* texture = nullptr;  // its red multiplies `factor`
  float cutoff = 0;                  // above 0: a mask

  // The scene must outlive it.
  [[nodiscard]] static Opacity of(const Material& material, const Scene& scene);
  // Whether all of the surface is there.
  [[nodiscard]] bool full() const { return texture == nullptr && !(factor < 1); }
  // The share of the surface that is there, in [0, 1]; 0 or 1 of a mask.
  [[nodiscard]] float at(const Vec2& uv) const;
};

// What rays meet, holes left out. A ray passes a surface of opacity a with probability 1 - a and goes
// on straight, so that a path knows nothing of it; a shadow ray brings 1 - a of the light.
class RayCaster {
 public:
  static constexpr float kEndless = std::numeric_limits<float>::infinity();
  // After so many surfaces that are passed the next counts as whole.
  static constexpr int kMostPassed = 4096;

  // All of them must outlive this object.
  RayCaster(const Scene& scene, const Accel& accel, const Shapes& shapes);

  // Finds what the ray meets first, at a distance in (0, reach]; returns false where that is
  // nothing. `direction` is unit; `time` as of Accel::intersect(). Takes a number of the sampler at
  // each surface that is neither whole nor a hole. Adds the rays that this took to `rays`.
  [[nodiscard]] bool nearest(const Vec3& origin, const Vec3& direction, float reach, float time,
                             Sampler& sampler, Hit& hit, std::uint64_t& rays) const;
  // The share of the light that comes through on the way from origin + reach * direction.
  // `direction` may have any length.
  [[nodiscard]] float transmittance(const Vec3& origin, const Vec3& direction, float reach,
                                    float time, std::uint64_t& rays) const;

  // The share of the light that passes a surface.
  [[nodiscard]] float passed(const Surface& surface) const {
    return opacities_.empty() ? 0.0f : 1 - opacity_of(surface);
  }

 private:
  [[nodiscard]] float opacity_of(const Surface& surface) const;
  // The distance from which on a ray looks on that has passed this hit.
  [[nodiscard]] static float behind(const Hit& hit, const Surface& surface);

  const Accel& accel_;
  const Shapes& shapes_;
  std::vector<Opacity> opacities_;  // by material; empty where every surface is whole
};

}  // namespace psf::render
