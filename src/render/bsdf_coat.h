// How much a rough dielectric coat reflects, so that the diffuse base beneath gets the rest.
#pragma once

#include <array>
#include <memory>

namespace psf::render {

// Directional albedo E(mu, roughness) of the single-scattering GGX lobe of a dielectric, and its
// cosine-weighted mean. Tabulated by deterministic quadrature: mu and perceptual roughness each
// linear.
class CoatAlbedo {
 public:
  explicit CoatAlbedo(float ior);
  // Of Schlick's Fresnel, which is linear in the reflectance f0 at normal incidence: this is the
  // albedo for f0 = 1, edge() that for 0, and f0 E1 + (1 - f0) E0 is any other.
  static CoatAlbedo schlick();
  [[nodiscard]] const CoatAlbedo* edge() const { return edge_.get(); }  // null for a dielectric

  // One roughness, ready for many directions.
  struct Row {
    const float *lower, *upper;  // kCosines values each
    float weight;                // of upper
    float mean;                  // of E over the hemisphere, cosine-weighted
    [[nodiscard]] float at(float mu) const;
  };
  [[nodiscard]] Row row(float roughness) const;

 private:
  // `fresnel`: reflectance of a cosine.
  template <class Fresnel>
  static CoatAlbedo tabulate(const Fresnel& fresnel);
  CoatAlbedo() = default;
  static constexpr int kCosines = 64, kRoughnesses = 32;
  std::array<std::array<float, kCosines>, kRoughnesses> table_;
  std::array<float, kRoughnesses> mean_;
  std::shared_ptr<const CoatAlbedo> edge_;
};

}  // namespace psf::render
