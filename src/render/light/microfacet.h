// Fresnel reflectance and the GGX distribution of visible normals, in a frame with the normal as z.
#pragma once

#include "render/light/frame.h"

namespace psf::render {

// Unpolarised reflectance of a smooth dielectric; 1 under total internal reflection. `cosine` >= 0
// is that of the arriving direction; `eta` is the index behind the surface over the index in front.
[[nodiscard]] inline float fresnel_dielectric(float cosine, float eta) {
  const float sin_t_sq = (1 - cosine * cosine) / (eta * eta);
  if (sin_t_sq >= 1) return 1;
  const float cosine_t = std::sqrt(1 - sin_t_sq);
  const float parallel = (eta * cosine - cosine_t) / (eta * cosine + cosine_t);
  const float perpendicular = (cosine - eta * cosine_t) / (cosine + eta * cosine_t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

// Schlick's approximation (1994) of the reflectance, with `f0` at normal incidence.
[[nodiscard]] inline Rgb fresnel_schlick(const Rgb& f0, float cosine) {
  const float x = std::clamp(1 - cosine, 0.0f, 1.0f), x_sq = x * x;
  return f0 + (Rgb(1, 1, 1) - f0) * (x_sq * x_sq * x);
}

// A surface with a smaller alpha is a perfect mirror, because single precision cannot resolve the
// lobe.
constexpr float kLeastAlpha = 1e-3f;

// Isotropic GGX with Smith's height-correlated shadowing (Heitz 2014); all directions have z > 0.
struct Ggx {
  float alpha_sq;

  [[nodiscard]] float d(const Vec3& h) const {
    const float e = (h.x * h.x + h.y * h.y) / alpha_sq + h.z * h.z;
    return kInvPi / (alpha_sq * e * e);
  }
  [[nodiscard]] float lambda(const Vec3& w) const {
    const float tan_sq = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    return 0.5f * (std::sqrt(1 + alpha_sq * tan_sq) - 1);
  }
  [[nodiscard]] float g1(const Vec3& w) const { return 1 / (1 + lambda(w)); }
  [[nodiscard]] float g2(const Vec3& o, const Vec3& i) const {
    return 1 / (1 + lambda(o) + lambda(i));
  }
  // Samples a normal h that is visible from `o`, by Dupuy and Benyoub 2023, "Sampling Visible GGX
  // Normals with Spherical Caps". The density of the direction reflected at h is d(h) g1(o) / (4
  // o.z).
  [[nodiscard]] Vec3 sample(const Vec3& o, const Vec2& u) const {
    const float alpha = std::sqrt(alpha_sq);
    const Vec3 v = normalize(Vec3(alpha * o.x, alpha * o.y, o.z));
    const float z = (1 - u.y) * (1 + v.z) - v.z;
    const Vec3 h = around_axis(u.x, 1 - z * z, z) + v;
    return normalize(Vec3(alpha * h.x, alpha * h.y, std::max(h.z, 1e-12f)));
  }
};

[[nodiscard]] inline Vec3 reflect(const Vec3& o, const Vec3& h) {
  return h * (2 * dot(o, h)) - o;
}

}  // namespace psf::render
