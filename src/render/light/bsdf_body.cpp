// The boundary of a body with a medium: into it, and what of the light in it leaves. Rough ones are
// those of Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces".
#include "render/light/bsdf.h"

namespace psf::render {
namespace {

constexpr float kLeastSlope = 1e-7f;  // cosine, below which a path is along the surface

// Refracts o at h, on whose side it is, into the side of index `eta` times its own; false where all
// is reflected.
bool refract(const Vec3& o, const Vec3& h, float eta, Vec3& refracted) {
  const float inverse = 1 / eta, cosine = dot(o, h);
  const float cosine_sq = 1 - (1 - cosine * cosine) * inverse * inverse;
  if (cosine_sq <= 0) return false;
  refracted = normalize(h * (cosine * inverse - std::sqrt(cosine_sq)) - o * inverse);
  return true;
}

Vec3 turned(const Vec3& v) {
  return {v.x, v.y, -v.z};
}

}  // namespace

Bsdf Bsdf::of_boundary(const Material& material) {
  Bsdf bsdf;
  bsdf.lobes_ = kBoundary;
  bsdf.reflectance_ = Rgb(1, 1, 1);
  bsdf.eta_ = 1 / material.ior;
  if (material.ior > 1) {
    bsdf.roughness_ = material.roughness;
    bsdf.alpha_ = material.roughness * material.roughness;
  }
  return bsdf;
}

Bsdf Bsdf::of_medium(const Medium& medium, const Rgb& albedo) {
  Bsdf bsdf;
  bsdf.lobes_ = kPhase;
  bsdf.reflectance_ = albedo;
  bsdf.mean_cosine_ = medium.g;
  return bsdf;
}

bool Bsdf::sample_into(const Vec3& o, const Vec2& u, float probability, BsdfSample& sample) const {
  sample.pdf = 0;
  sample.inside = true;
  sample.weight = Rgb(1 / probability);
  if (eta_ == 1) {
    sample.direction = -o;
    return true;
  }
  const Ggx ggx{alpha_ * alpha_};
  const bool rough = alpha_ >= kLeastAlpha;
  const Vec3 h = rough ? ggx.sample(o, u) : Vec3(0, 0, 1);
  const float cosine = std::min(1.0f, dot(o, h));
  if (!refract(o, h, eta_, sample.direction) || sample.direction.z >= 0) return false;
  sample.weight *= 1 - fresnel_dielectric(cosine, eta_);
  if (rough) sample.weight *= ggx.g2(o, sample.direction) / ggx.g1(o);
  return true;
}

bool Bsdf::sample_boundary(const Vec3& o, const Vec2& u, float choice, BsdfSample& sample) const {
  sample.pdf = 0;
  sample.weight = Rgb(1, 1, 1);
  if (eta_ == 1) {
    sample.direction = -o;
    sample.straight = true;
    return true;
  }
  const Vec3 within = turned(o);
  if (within.z < kLeastSlope) return false;
  const Ggx ggx{alpha_ * alpha_};
  const bool rough = alpha_ >= kLeastAlpha;
  const Vec3 h = rough ? ggx.sample(within, u) : Vec3(0, 0, 1);
  const float cosine = std::min(1.0f, dot(within, h));
  Vec3 to;
  if (choice < fresnel_dielectric(cosine, eta_)) {
    to = reflect(within, h);
    if (to.z <= 0) return false;
    sample.inside = true;
    sample.direction = turned(to);
  } else {
    if (!refract(within, h, eta_, to) || to.z >= 0) return false;
    sample.direction = turned(to);
    if (rough) static_cast<void>(evaluate_boundary(o, sample.direction, sample.pdf));
  }
  if (rough) sample.weight *= ggx.g2(within, to) / ggx.g1(within);
  return true;
}

float Bsdf::evaluate_boundary(const Vec3& o, const Vec3& i, float& pdf) const {
  pdf = 0;
  const Vec3 within = turned(o), to = turned(i);
  if (within.z < kLeastSlope || to.z >= 0 || alpha_ < kLeastAlpha) return 0;
  // Outside is thinner, so the normal is on the side of the path.
  const Vec3 h = normalize(within + to * eta_);
  const float cosine = dot(within, h), cosine_to = dot(to, h);
  if (h.z <= 0 || cosine <= 0 || cosine_to >= 0) return 0;
  const Ggx ggx{alpha_ * alpha_};
  const float slope = cosine + eta_ * cosine_to;
  pdf = (1 - fresnel_dielectric(std::min(1.0f, cosine), eta_)) * ggx.d(h) * ggx.g1(within) *
        cosine / within.z * (eta_ * eta_ * -cosine_to) / (slope * slope);
  return pdf * ggx.g2(within, to) / ggx.g1(within);
}

}  // namespace psf::render
