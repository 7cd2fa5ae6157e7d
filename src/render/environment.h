// Light from infinity: a constant sky, or an equirectangular map sampled by luminance times solid
// angle.
#pragma once

#include <vector>

#include "core/vec.h"
#include "render/distribution.h"
#include "render/scene.h"

namespace psf::render {

// A constant sky is not sampled: every material's own scattering is the perfect density for it.
class EnvironmentLight {
 public:
  EnvironmentLight() = default;
  // The scene must outlive it.
  explicit EnvironmentLight(const Scene& scene);

  [[nodiscard]] bool sampled() const { return map_ != nullptr; }
  // Integral of luminance over the sphere of directions.
  [[nodiscard]] float power() const { return power_; }
  // Radiance arriving from the unit `direction` (pointing to the sky). Bilinear; the map does not
  // wrap at the poles.
  [[nodiscard]] Rgb radiance(const Vec3& direction) const;
  // Only where sampled(). The density is constant over each texel.
  [[nodiscard]] Vec3 sample(Vec2 u, float& pdf) const;
  [[nodiscard]] float pdf(const Vec3& direction) const;

 private:
  [[nodiscard]] float texel_pdf(std::size_t x, std::size_t y) const;
  [[nodiscard]] Vec3 to_map(const Vec3& v) const;
  [[nodiscard]] Vec3 from_map(const Vec3& v) const;

  Rgb scale_{0, 0, 0};
  const Texture* map_ = nullptr;
  float cosine_ = 1, sine_ = 0;  // of the rotation
  float power_ = 0;
  Distribution rows_;
  std::vector<Distribution> columns_;
  std::vector<float> heights_;  // y of row boundaries, top to bottom
};

}  // namespace psf::render
