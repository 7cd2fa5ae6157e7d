// Light from infinity: a constant sky, or an equirectangular map sampled by luminance times solid
// angle.
#pragma once

#include <vector>

#include "core/vec.h"
#include "render/light/distribution.h"
#include "render/scene/scene.h"

namespace psf::render {

// A constant sky is not sampled, because the scattering of every material is already the best
// density for it.
class EnvironmentLight {
 public:
  EnvironmentLight() = default;
  // The scene must outlive it.
  explicit EnvironmentLight(const Scene& scene);

  [[nodiscard]] bool sampled() const { return map_ != nullptr; }
  [[nodiscard]] bool black() const { return is_black(scale_); }
  // Integral of luminance over the sphere of directions.
  [[nodiscard]] float power() const { return power_; }
  // The radiance that arrives from the sky in the unit `direction`, which points to the sky. The
  // map is interpolated bilinearly and does not wrap at the poles.
  [[nodiscard]] Rgb radiance(const Vec3& direction) const;
  // Samples a direction, and returns the density of a direction; of a map alone where a surface is
  // lit. The density is constant over each texel, or everywhere.
  [[nodiscard]] Vec3 sample(Vec2 u, float& pdf) const;
  [[nodiscard]] float pdf(const Vec3& direction) const;

 private:
  [[nodiscard]] float texel_pdf(std::size_t x, std::size_t y) const;
  [[nodiscard]] Vec3 to_map(const Vec3& v) const;
  [[nodiscard]] Vec3 from_map(const Vec3& v) const;

  Rgb scale_{0, 0, 0};
  const Texture* map_ = nullptr;
  float cosine_ = 1, sine_ = 0;  // of the map's rotation angle
  float power_ = 0;
  Distribution rows_;
  std::vector<Distribution> columns_;
  std::vector<float> heights_;  // y of row boundaries, top to bottom
};

}  // namespace psf::render
