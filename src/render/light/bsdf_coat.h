// The albedo of a rough dielectric coat; the diffuse base beneath gets the rest of the light.
#pragma once

#include <array>
#include <memory>

namespace psf::render {

// The directional albedo E(mu, roughness) of the single-scattering GGX lobe of a dielectric, and
// its cosine-weighted mean, where mu is the cosine. They are tabulated by deterministic quadrature
// and interpolated linearly in mu and perceptual roughness.
class CoatAlbedo {
 public:
  explicit CoatAlbedo(float ior);
  // The albedo with Schlick's Fresnel, which is linear in the reflectance f0 at normal incidence.
  // The returned table E1 is for f0 = 1, its edge() E0 for f0 = 0; f0 E1 + (1 - f0) E0 is the
  // albedo for any f0.
  static CoatAlbedo schlick();
  // The albedo of the lobe alone, as where all is reflected, for metals that keep what this lacks of
  // 1: by finer quadrature than the others, as light is lost in the rare tail of the lobe.
  static CoatAlbedo white();
  [[nodiscard]] const CoatAlbedo* edge() const { return edge_.get(); }  // null for a dielectric

  // One roughness, ready for many directions.
  struct Row {
    const float *lower, *upper;  // kCosines values each
    float weight;                // weight of `upper` in the interpolation
    float mean;                  // cosine-weighted mean of E over the hemisphere
    [[nodiscard]] float at(float mu) const;
  };
  [[nodiscard]] Row row(float roughness) const;

 private:
  // `directional` returns E for a cosine and a roughness.
  template <class Directional>
  static CoatAlbedo tabulate(const Directional& directional);
  CoatAlbedo() = default;
  static constexpr int kCosines = 64, kRoughnesses = 32;
  std::array<std::array<float, kCosines>, kRoughnesses> table_;
  std::array<float, kRoughnesses> mean_;
  std::shared_ptr<const CoatAlbedo> edge_;
};

}  // namespace psf::render
