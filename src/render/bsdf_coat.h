// How much a rough dielectric coat reflects, so that the diffuse base beneath gets the rest.
#pragma once

#include <array>

namespace psf::render {

// Directional albedo E(mu, roughness) of the single-scattering GGX lobe of a dielectric, and its
// cosine-weighted mean. Tabulated by deterministic quadrature: mu and perceptual roughness each
// linear.
class CoatAlbedo {
 public:
  explicit CoatAlbedo(float ior);

  // One roughness, ready for many directions.
  struct Row {
    const float *lower, *upper;  // kCosines values each
    float weight;                // of upper
    float mean;                  // of E over the hemisphere, cosine-weighted
    [[nodiscard]] float at(float mu) const;
  };
  [[nodiscard]] Row row(float roughness) const;

 private:
  static constexpr int kCosines = 64, kRoughnesses = 32;
  std::array<std::array<float, kCosines>, kRoughnesses> table_;
  std::array<float, kRoughnesses> mean_;
};

}  // namespace psf::render
