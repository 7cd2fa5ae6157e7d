// Scattering at a surface: the lobes of one material at one point, in a frame whose z axis is the
// shading normal.
#pragma once

#include <cstdint>

#include "core/vec.h"
#include "render/light/bsdf_coat.h"
#include "render/light/microfacet.h"
#include "render/scene/scene.h"

namespace psf::render {

struct BsdfSample {
  Vec3 direction;       // local, unit
  Rgb weight;           // f cos / pdf
  float pdf = 0;        // per solid angle; 0 for a perfect mirror or refraction
  float eta_scale = 1;  // (index left / index entered)^2 where the path crossed a glass surface
};

// Directions are local unit vectors that point away from the surface. o is the direction toward the
// camera, with o.z > 0, and i the other one. By material:
//
//   diffuse    rho / pi.
//   conductor  GGX with Schlick's Fresnel F, which is light that bounces once. Unless the material
//              leaves it out, light that bounces more often is kept, too:
//              M / pi (1 - E(o)) (1 - E(i)) / (1 - mean E), where E is the albedo of GGX alone and
//              M = (mean F)^2 mean E / (1 - mean F (1 - mean E)) (Kulla and Conty 2017). So white
//              reflects all that it gets, and the rougher a colour is the deeper.
//   coat       (1 - m) (GGX with the dielectric's Fresnel + base) + m (GGX with Schlick's Fresnel),
//              where m is the metalness, and the metal is a
//              conductor. The base is
//              rho / pi (1 - E(o)) (1 - E(i)) / (1 - mean E) (Kelemen and Szirmay-Kalos 2001): it
//              gets the light that the coat does not reflect on the way in and out. This replaces
//              refraction and all interreflection between coat and base, without making the base's
//              colour deeper. It is reciprocal, and the total albedo is E(o) + rho (1 - E(o)).
//   gloss      GGX with Schlick's Fresnel, over the same base; E is a colour.
//   mirror     perfect reflection.
//   glass      perfect reflection and refraction; it refracts with probability 1 - Fresnel.
//
// GGX with alpha < kLeastAlpha is a perfect mirror.
class Bsdf {
 public:
  static constexpr std::uint8_t kDiffuse = 1, kGlossy = 2, kGlass = 4;

  // `coat`: for coats the table of the material's ior, for gloss that of Schlick's Fresnel.
  // `white`: CoatAlbedo::white() for metals with multiple scattering, else null. `front`: the camera
  // is on the front side.
  Bsdf(const Material& material, const Scene& scene, const Vec2& uv, bool front,
       const CoatAlbedo* coat, const CoatAlbedo* white = nullptr);

  [[nodiscard]] bool black() const { return lobes_ == 0; }
  // Whether every lobe is perfect, so that none can be evaluated and light sampling has no use.
  [[nodiscard]] bool perfect() const { return (lobes_ & kDiffuse) == 0 && alpha_ < kLeastAlpha; }
  // Whether sample() uses its argument `choice`.
  [[nodiscard]] bool chooses() const {
    return lobes_ == kGlass || lobes_ == (kDiffuse | kGlossy) || many();
  }
  // Perceptual roughness of the roughest lobe; 1 for diffuse, 0 for mirror and glass.
  [[nodiscard]] float roughness() const { return (lobes_ & kDiffuse) != 0 ? 1.0f : roughness_; }
  // Perceptual roughness of the smoothest lobe, for which the direction of view matters most.
  [[nodiscard]] float least_roughness() const {
    return (lobes_ & kGlossy) != 0 ? roughness_ : roughness();
  }
  // Whether there are two lobes and only the diffuse one has a roughness of at least `threshold`. A
  // perfect lobe never has.
  [[nodiscard]] bool straddles(float threshold) const {
    return lobes_ == (kDiffuse | kGlossy) && (roughness_ < threshold || alpha_ < kLeastAlpha);
  }
  // The probability of sampling the glossy lobe where there is a diffuse lobe too.
  [[nodiscard]] float glossy_probability(const Vec3& o) const;
  void keep(std::uint8_t lobe) { lobes_ = lobe; }
  // The albedo at normal incidence of the lobes that are kept.
  [[nodiscard]] Rgb albedo() const;

  // Returns f cos, without perfect lobes, and sets `pdf` to the density of sample().
  [[nodiscard]] Rgb evaluate(const Vec3& o, const Vec3& i, float& pdf) const;
  // The share of evaluate() that is the diffuse lobe's, by colour; 0 where that is 0.
  [[nodiscard]] Rgb diffuse_share(const Vec3& o, const Vec3& i) const;
  // Samples a direction; returns false where the path is absorbed. `choice` selects a lobe, `u` a
  // direction in it.
  [[nodiscard]] bool sample(const Vec3& o, const Vec2& u, float choice, BsdfSample& sample) const;

 private:
  [[nodiscard]] Rgb glossy_fresnel(float cosine) const;
  // E of a gloss, from E for a specular reflectance of 1 (`white`) and of 0 (`edge`).
  [[nodiscard]] Rgb gloss_albedo(float white, float edge) const;
  [[nodiscard]] Rgb diffuse(float o_z, float i_z) const;
  // Whether the glossy lobe has light of more than one bounce.
  [[nodiscard]] bool many() const { return (lobes_ & kGlossy) != 0 && white_.lower != nullptr; }
  // The radiance, over the light's, of more than one bounce.
  [[nodiscard]] Rgb many_bounces(float o_z, float i_z) const;
  // The probability of sampling it where the glossy lobe is sampled.
  [[nodiscard]] float many_probability(float o_z) const;
  void set_many_bounces(const CoatAlbedo& white);
  [[nodiscard]] bool sample_glass(const Vec3& o, float choice, BsdfSample& sample) const;

  Rgb reflectance_;      // of base or mirror; of a conductor at normal incidence; tint of glass
  Rgb specular_;         // reflectance of gloss at normal incidence
  float roughness_ = 0;  // perceptual, of the glossy lobe
  float alpha_ = 0;
  float metalness_ = 0;  // 1 for conductor
  float eta_ = 1;        // index behind over index in front
  std::uint8_t lobes_ = 0;
  bool mirror_ = false;      // Fresnel is 1
  CoatAlbedo::Row coat_{};   // lower == null: no coat
  CoatAlbedo::Row edge_{};   // lower == null: no gloss
  CoatAlbedo::Row white_{};  // lower == null: one bounce alone
  Rgb many_{0, 0, 0};        // the constant factor of many_bounces()
};

}  // namespace psf::render
