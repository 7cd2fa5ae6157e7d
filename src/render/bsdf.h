// How a surface scatters: the lobes of one material at one point, in a frame with the shading
// normal as z.
#pragma once

#include <cstdint>

#include "core/vec.h"
#include "render/bsdf_coat.h"
#include "render/microfacet.h"
#include "render/scene.h"

namespace psf::render {

struct BsdfSample {
  Vec3 direction;       // local, unit
  Rgb weight;           // f cos / pdf
  float pdf = 0;        // by solid angle; 0 for a perfect mirror or refraction
  float eta_scale = 1;  // (index left / index entered)^2 where the path crossed into glass
};

// Directions are local and unit, point away from the surface, and o.z > 0 is the one toward the
// camera.
//
// diffuse     rho / pi.
// conductor   GGX, Fresnel by Schlick. Light that would bounce more than once between microfacets
// is lost, so a
//             rough white conductor reflects less than 1.
// coat        (1 - m) (GGX with the dielectric's Fresnel + base) + m (GGX with Schlick's Fresnel).
// The base is
//             rho / pi (1 - E(o)) (1 - E(i)) / (1 - mean E) (Kelemen and Szirmay-Kalos 2001): what
//             the coat does not reflect on the way in and out, which stands for refraction and all
//             interreflection between coat and base without the base's colour deepening.
//             Reciprocal, and E(o) + rho (1 - E(o)) in all.
// gloss       The same with Schlick's Fresnel, where E is a colour.
// mirror, glass  perfect; glass refracts with probability 1 - Fresnel.
// GGX with alpha < kLeastAlpha is perfect too.
class Bsdf {
 public:
  static constexpr std::uint8_t kDiffuse = 1, kGlossy = 2, kGlass = 4;

  // `coat`: the table of the material's ior for coats, Schlick's for gloss. `front`: the camera is
  // on the outside.
  Bsdf(const Material& material, const Scene& scene, const Vec2& uv, bool front,
       const CoatAlbedo* coat);

  [[nodiscard]] bool black() const { return lobes_ == 0; }
  // No lobe can be evaluated: light sampling is pointless.
  [[nodiscard]] bool perfect() const { return (lobes_ & kDiffuse) == 0 && alpha_ < kLeastAlpha; }
  // sample() needs a `choice`.
  [[nodiscard]] bool chooses() const { return lobes_ == kGlass || lobes_ == (kDiffuse | kGlossy); }
  // Perceptual roughness of the roughest lobe; 1 for diffuse, 0 for mirror and glass.
  [[nodiscard]] float roughness() const { return (lobes_ & kDiffuse) != 0 ? 1.0f : roughness_; }
  // Perceptual roughness of the smoothest lobe: what the direction of view matters to.
  [[nodiscard]] float least_roughness() const {
    return (lobes_ & kGlossy) != 0 ? roughness_ : roughness();
  }
  // Both lobes are there and only the diffuse one reaches `threshold`; a perfect lobe never does.
  [[nodiscard]] bool straddles(float threshold) const {
    return lobes_ == (kDiffuse | kGlossy) && (roughness_ < threshold || alpha_ < kLeastAlpha);
  }
  // How likely the glossy lobe is sampled where there are both.
  [[nodiscard]] float glossy_probability(const Vec3& o) const;
  void keep(std::uint8_t lobe) { lobes_ = lobe; }
  // Albedo at normal incidence of the lobes kept.
  [[nodiscard]] Rgb albedo() const;

  // f cos and the density of sample(), without perfect lobes.
  [[nodiscard]] Rgb evaluate(const Vec3& o, const Vec3& i, float& pdf) const;
  // False where the path is absorbed. `choice` selects a lobe, `u` a direction in it.
  [[nodiscard]] bool sample(const Vec3& o, const Vec2& u, float choice, BsdfSample& sample) const;

 private:
  [[nodiscard]] Rgb glossy_fresnel(float cosine) const;
  // E of gloss, from those of a specular reflectance of 1 and of 0.
  [[nodiscard]] Rgb gloss_albedo(float white, float edge) const;
  [[nodiscard]] Rgb diffuse(float o_z, float i_z) const;
  [[nodiscard]] bool sample_glass(const Vec3& o, float choice, BsdfSample& sample) const;

  Rgb reflectance_;  // of the base, of the conductor at normal incidence, of mirror; tint of glass
  Rgb specular_;     // of gloss
  float roughness_ = 0;  // perceptual, of the glossy lobe
  float alpha_ = 0;
  float metalness_ = 0;  // 1 for conductor
  float eta_ = 1;        // index behind over index in front
  std::uint8_t lobes_ = 0;
  bool mirror_ = false;     // Fresnel is 1
  CoatAlbedo::Row coat_{};  // lower == null: no coat
  CoatAlbedo::Row edge_{};  // lower == null: no gloss
};

}  // namespace psf::render
