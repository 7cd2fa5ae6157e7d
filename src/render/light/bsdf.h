// Scattering at a surface: the lobes of one material at one point, in a frame whose z axis is the
// shading normal.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/vec.h"
#include "render/light/bsdf_coat.h"
#include "render/light/microfacet.h"
#include "render/scene/scene.h"

namespace psf::render {

struct BsdfSample {
  Vec3 direction;         // local, unit
  Rgb weight;             // f cos / pdf
  float pdf = 0;          // per solid angle; 0 for a perfect mirror or refraction
  float eta_scale = 1;    // (index left / index entered)^2 where the path crossed a glass surface
  bool inside = false;    // the path goes on in a body with a medium
  bool straight = false;  // it went on as it came, through a boundary that does not refract
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
//              Above it may be a clear coat of weight c, GGX with a dielectric's Fresnel of index
//              1.5: c GGX + coat (1 - c C(o)) (1 - c C(i)), where C is its albedo. What light
//              bounces between the two is left out.
//   gloss      GGX with Schlick's Fresnel, over the same base; E is a colour.
//   mirror     perfect reflection.
//   glass      perfect reflection and refraction; it refracts with probability 1 - Fresnel.
//   subsurface reflection, perfect or GGX, with the dielectric's Fresnel, and a lobe into the body,
//              which can be sampled alone: light that it brings back leaves elsewhere. Radiance
//              that is denser inside is not counted so, since all of it leaves again.
//
// Two more are met in a body: of_boundary(), where z is outside and o.z < 0, and of_medium(), in
// which light goes on in all directions and o is z.
//
// GGX with alpha < kLeastAlpha is a perfect mirror.
class Bsdf {
 public:
  static constexpr std::uint8_t kDiffuse = 1, kGlossy = 2, kGlass = 4, kClear = 8;
  static constexpr float kClearIor = 1.5f;
  // Into a body, its boundary seen from inside, and scattering in its medium.
  static constexpr std::uint8_t kInto = 32, kBoundary = 64, kPhase = 128;

  // `coat`: for coats the table of the material's ior, for gloss that of Schlick's Fresnel.
  // `white`: CoatAlbedo::white() for metals with multiple scattering, else null. `front`: the camera
  // is on the front side. `clear`: for clear coats the table of kClearIor.
  Bsdf(const Material& material, const Scene& scene, const Vec2& uv, bool front,
       const CoatAlbedo* coat, const CoatAlbedo* white = nullptr,
       const CoatAlbedo* clear = nullptr);
  // `material`: of the kind subsurface.
  [[nodiscard]] static Bsdf of_boundary(const Material& material);
  // `albedo`: what is scattered.
  [[nodiscard]] static Bsdf of_medium(const Medium& medium, const Rgb& albedo);

  [[nodiscard]] bool black() const { return lobes_ == 0; }
  // Whether every lobe is perfect, so that none can be evaluated and light sampling has no use.
  [[nodiscard]] bool perfect() const {
    if (has_clear()) return roughest() < kLeastAlpha;
    return (lobes_ & (kDiffuse | kInto | kPhase)) == 0 && alpha_ < kLeastAlpha;
  }
  // Whether evaluate() can be anything but 0.
  [[nodiscard]] bool evaluates() const {
    if (has_clear()) return !perfect();
    return (lobes_ & (kDiffuse | kPhase)) != 0 || ((lobes_ & ~kInto) != 0 && alpha_ >= kLeastAlpha);
  }
  // Whether light goes on in all directions, as in a medium.
  [[nodiscard]] bool everywhere() const { return lobes_ == kPhase; }
  [[nodiscard]] bool is_glass() const { return lobes_ == kGlass; }
  // Whether there is a lobe into a body.
  [[nodiscard]] bool enters() const { return (lobes_ & kInto) != 0; }
  // Whether sample() uses its argument `choice`.
  [[nodiscard]] bool chooses() const {
    return lobes_ == kGlass || has_two() || (lobes_ & kClear) != 0 ||
           (lobes_ == kBoundary && eta_ != 1) || many();
  }
  // Perceptual roughness of the roughest lobe; 1 for diffuse and media, 0 for mirror and glass.
  [[nodiscard]] float roughness() const {
    if (has_clear()) return std::sqrt(roughest());
    return (lobes_ & (kDiffuse | kInto | kPhase)) != 0 ? 1.0f : roughness_;
  }
  // Perceptual roughness of the smoothest lobe, for which the direction of view matters most.
  [[nodiscard]] float least_roughness() const {
    const float below = (lobes_ & kGlossy) != 0 ? roughness_ : roughness();
    return (lobes_ & kClear) != 0 ? std::min(below, clear_roughness_) : below;
  }
  // The lobes whose roughness is below `threshold`, and perfect ones, where there are others too;
  // else none.
  [[nodiscard]] std::uint8_t smooth_lobes(float threshold) const;
  [[nodiscard]] bool straddles(float threshold) const { return smooth_lobes(threshold) != 0; }
  // The probability of sampling one of some lobes.
  [[nodiscard]] float probability(std::uint8_t lobes, const Vec3& o) const;
  // The probability of sampling the glossy lobe where there is a diffuse one too, or that into a
  // body, and no clear coat.
  [[nodiscard]] float glossy_probability(const Vec3& o) const;
  void keep(std::uint8_t lobes) { lobes_ = lobes; }
  [[nodiscard]] std::uint8_t lobes() const { return lobes_; }
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
  Bsdf() = default;
  [[nodiscard]] bool has_two() const {
    return lobes_ == (kDiffuse | kGlossy) || lobes_ == (kInto | kGlossy);
  }
  // The clear coat, and all beneath it: bsdf_clear.cpp.
  [[nodiscard]] bool has_clear() const { return clear_row_.lower != nullptr; }
  void set_clear(const Material& material, const Scene& scene, const Vec2& uv,
                 const CoatAlbedo& table);
  [[nodiscard]] Bsdf beneath() const;
  [[nodiscard]] float through_clear(float cosine) const {
    return 1 - clear_ * clear_row_.at(cosine);
  }
  [[nodiscard]] float clear_probability(const Vec3& o) const;
  [[nodiscard]] float roughest() const;  // alpha of the roughest lobe
  [[nodiscard]] Rgb clear_albedo() const;
  [[nodiscard]] Rgb evaluate_clear(const Vec3& o, const Vec3& i, float& pdf) const;
  [[nodiscard]] bool sample_clear(const Vec3& o, const Vec2& u, float choice,
                                  BsdfSample& sample) const;
  // The surface of a body, and places in it: bsdf_body.cpp.
  [[nodiscard]] bool sample_into(const Vec3& o, const Vec2& u, float probability,
                                 BsdfSample& sample) const;
  [[nodiscard]] bool sample_boundary(const Vec3& o, const Vec2& u, float choice,
                                     BsdfSample& sample) const;
  [[nodiscard]] float evaluate_boundary(const Vec3& o, const Vec3& i, float& pdf) const;
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

  // Of base or mirror; of a conductor at normal incidence; of a body; tint of glass.
  Rgb reflectance_{0, 0, 0};
  Rgb specular_{0, 0, 0};  // reflectance of gloss at normal incidence
  float roughness_ = 0;    // perceptual, of the glossy lobe
  float alpha_ = 0;
  float metalness_ = 0;    // 1 for conductor
  float eta_ = 1;          // index behind over index in front; of a boundary outside over inside
  float mean_cosine_ = 0;  // of scattering in a medium
  std::uint8_t lobes_ = 0;
  bool mirror_ = false;      // Fresnel is 1
  CoatAlbedo::Row coat_{};   // lower == null: no coat
  CoatAlbedo::Row edge_{};   // lower == null: no gloss
  CoatAlbedo::Row white_{};  // lower == null: one bounce alone
  Rgb many_{0, 0, 0};        // the constant factor of many_bounces()
  float clear_ = 0;          // weight of the clear coat
  float clear_roughness_ = 0, clear_alpha_ = 0;
  CoatAlbedo::Row clear_row_{};  // lower == null: no clear coat
};

}  // namespace psf::render
