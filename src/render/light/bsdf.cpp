// How a surface scatters: evaluation and sampling of its lobes.
#include "render/light/bsdf.h"

#include "render/light/medium.h"

namespace psf::render {

namespace {

// Below it a rough lobe's density overflows.
constexpr float kLeastCosine = 1e-7f;

}  // namespace

Bsdf::Bsdf(const Material& material, const Scene& scene, const Vec2& uv, bool front,
           const CoatAlbedo* coat, const CoatAlbedo* white, const CoatAlbedo* clear)
    : reflectance_(material.reflectance), specular_(material.specular) {
  const bool glass = material.kind == MaterialKind::glass;
  if (!front && !material.two_sided && !glass) return;
  const auto texture = [&](int index) -> const Texture& {
    return scene.textures[static_cast<std::size_t>(index)];
  };
  if (material.reflectance_texture != kNone) {
    reflectance_ = reflectance_ * texture(material.reflectance_texture).at(uv);
  }
  const bool coated = material.kind == MaterialKind::coat || material.kind == MaterialKind::gloss;
  const bool body = material.kind == MaterialKind::subsurface && material.ior > 1;
  if (material.kind == MaterialKind::conductor || coated || body) {
    roughness_ = material.roughness;
    metalness_ = material.kind == MaterialKind::conductor ? 1
                 : material.kind == MaterialKind::coat    ? material.metalness
                                                          : 0;
    if (material.roughness_metalness_texture != kNone) {
      const Rgb factors = texture(material.roughness_metalness_texture).at(uv);
      roughness_ *= factors.y;
      if (material.kind == MaterialKind::coat) metalness_ *= factors.z;
    }
    roughness_ = std::clamp(roughness_, 0.0f, 1.0f);
    metalness_ = std::clamp(metalness_, 0.0f, 1.0f);
    alpha_ = roughness_ * roughness_;
  }
  switch (material.kind) {
    case MaterialKind::volume:  // no surface
      break;
    case MaterialKind::diffuse:
      lobes_ = kDiffuse;
      break;
    case MaterialKind::mirror:
      lobes_ = kGlossy;
      mirror_ = true;
      break;
    case MaterialKind::glass:
      lobes_ = kGlass;
      eta_ = front ? material.ior : 1 / material.ior;
      break;
    case MaterialKind::conductor:
      lobes_ = kGlossy;
      break;
    case MaterialKind::coat:
      lobes_ = metalness_ < 1 && !is_black(reflectance_) ? kDiffuse | kGlossy : kGlossy;
      eta_ = material.ior;
      coat_ = coat->row(roughness_);
      break;
    case MaterialKind::gloss:
      lobes_ = is_black(reflectance_) ? kGlossy : kDiffuse | kGlossy;
      coat_ = coat->row(roughness_);
      edge_ = coat->edge()->row(roughness_);
      break;
    case MaterialKind::subsurface:
      // A body is seen from outside alone.
      if (!front) break;
      eta_ = material.ior;
      lobes_ = eta_ > 1 ? kInto | kGlossy : kInto;
      reflectance_ =
          body_albedo(scene.media[static_cast<std::size_t>(material.interior)], material.ior);
      break;
  }
  if (white != nullptr && metalness_ > 0 && alpha_ >= kLeastAlpha) set_many_bounces(*white);
  if (clear != nullptr && material.clearcoat > 0) set_clear(material, scene, uv, *clear);
}

void Bsdf::set_many_bounces(const CoatAlbedo& white) {
  white_ = white.row(roughness_);
  const float lost = std::max(1e-6f, 1 - white_.mean);
  for (int c = 0; c < 3; ++c) {
    const float fresnel = reflectance_[c] + (1 - reflectance_[c]) / 21;  // Schlick's, on average
    many_[c] = metalness_ * fresnel * fresnel * white_.mean / (1 - fresnel * lost) * kInvPi / lost;
  }
}

Rgb Bsdf::many_bounces(float o_z, float i_z) const {
  return many_ * (std::max(0.0f, 1 - white_.at(o_z)) * std::max(0.0f, 1 - white_.at(i_z)));
}

float Bsdf::many_probability(float o_z) const {
  if (!many()) return 0;
  const float once = white_.at(o_z), lost = std::max(0.0f, 1 - once);
  const float many = luminance(many_) * kPi * lost * std::max(1e-6f, 1 - white_.mean);
  const float single = once * luminance(glossy_fresnel(o_z));
  return many > 0 ? std::clamp(many / (many + single), 0.01f, 0.99f) : 0;
}

Rgb Bsdf::glossy_fresnel(float cosine) const {
  if (mirror_) return reflectance_;
  if (edge_.lower != nullptr) return fresnel_schlick(specular_, cosine);
  Rgb f(0, 0, 0);
  if (metalness_ > 0) f = fresnel_schlick(reflectance_, cosine) * metalness_;
  if (metalness_ < 1) {
    const float d = (1 - metalness_) * fresnel_dielectric(cosine, eta_);
    f += Rgb(d, d, d);
  }
  return f;
}

Rgb Bsdf::gloss_albedo(float white, float edge) const {
  return specular_ * white + (Rgb(1) - specular_) * edge;
}

Rgb Bsdf::diffuse(float o_z, float i_z) const {
  if (coat_.lower == nullptr) return reflectance_ * kInvPi;
  if (edge_.lower != nullptr) {
    const auto left = [&](float mu) { return Rgb(1) - gloss_albedo(coat_.at(mu), edge_.at(mu)); };
    Rgb mean = Rgb(1) - gloss_albedo(coat_.mean, edge_.mean);
    for (int c = 0; c < 3; ++c) mean[c] = std::max(1e-6f, mean[c]);
    return reflectance_ * left(o_z) * left(i_z) / mean * kInvPi;
  }
  const float through = (1 - coat_.at(o_z)) * (1 - coat_.at(i_z)) / std::max(1e-6f, 1 - coat_.mean);
  return reflectance_ * (kInvPi * (1 - metalness_) * through);
}

float Bsdf::glossy_probability(const Vec3& o) const {
  if (!has_two()) return (lobes_ & kGlossy) != 0 ? 1.0f : 0.0f;
  const float coat = enters() ? fresnel_dielectric(o.z, eta_) : coat_.at(o.z);
  float glossy =
      (1 - metalness_) * coat + metalness_ * luminance(fresnel_schlick(reflectance_, o.z));
  float base = (1 - metalness_) * (1 - coat) * luminance(reflectance_);
  if (edge_.lower != nullptr) {
    const Rgb gloss = gloss_albedo(coat, edge_.at(o.z));
    glossy = luminance(gloss);
    base = luminance((Rgb(1) - gloss) * reflectance_);
  }
  // Neither lobe is ever starved: a path of the rarer one would weigh too much.
  return glossy + base > 0 ? std::clamp(glossy / (glossy + base), 0.05f, 0.95f) : 0.5f;
}

std::uint8_t Bsdf::smooth_lobes(float threshold) const {
  std::uint8_t smooth = 0;
  if ((lobes_ & kClear) != 0 && (clear_roughness_ < threshold || clear_alpha_ < kLeastAlpha))
    smooth |= kClear;
  if ((lobes_ & kGlossy) != 0 && (roughness_ < threshold || alpha_ < kLeastAlpha))
    smooth |= kGlossy;
  return smooth == lobes_ ? 0 : smooth;
}

float Bsdf::probability(std::uint8_t lobes, const Vec3& o) const {
  if (!has_clear()) return (lobes & kGlossy) != 0 ? glossy_probability(o) : 0;
  const float clear = clear_probability(o), glossy = beneath().glossy_probability(o);
  return ((lobes & kClear) != 0 ? clear : 0) +
         (1 - clear) *
             (((lobes & kGlossy) != 0 ? glossy : 0) + ((lobes & kDiffuse) != 0 ? 1 - glossy : 0));
}

Rgb Bsdf::albedo() const {
  if (has_clear()) return clear_albedo();
  const bool has_diffuse = (lobes_ & (kDiffuse | kInto)) != 0, has_glossy = (lobes_ & kGlossy) != 0;
  if (has_diffuse == has_glossy) {
    if (!has_diffuse) return reflectance_;
    const Rgb f0 = glossy_fresnel(1);
    if (edge_.lower != nullptr) return f0 + reflectance_ * (Rgb(1) - f0);
    return f0 + reflectance_ * ((1 - metalness_) * (1 - fresnel_dielectric(1, eta_)));
  }
  return has_diffuse ? reflectance_ : glossy_fresnel(1);
}

Rgb Bsdf::evaluate(const Vec3& o, const Vec3& i, float& pdf) const {
  if (has_clear()) return evaluate_clear(o, i, pdf);
  if (lobes_ == kPhase) {
    pdf = phase(mean_cosine_, -i.z);
    return reflectance_ * pdf;
  }
  if (lobes_ == kBoundary) return Rgb(evaluate_boundary(o, i, pdf));
  pdf = 0;
  Rgb f(0, 0, 0);
  if (o.z < kLeastCosine || i.z <= 0) return f;
  if (lobes_ == kDiffuse) {
    pdf = i.z * kInvPi;
    return diffuse(o.z, i.z) * i.z;
  }
  const float p_glossy = glossy_probability(o);
  if ((lobes_ & kDiffuse) != 0) {
    f = diffuse(o.z, i.z) * i.z;
    pdf = (1 - p_glossy) * i.z * kInvPi;
  }
  if ((lobes_ & kGlossy) != 0 && alpha_ >= kLeastAlpha) {
    const Ggx ggx{alpha_ * alpha_};
    const Vec3 h = normalize(o + i);
    const float d = ggx.d(h) / (4 * o.z);
    f += glossy_fresnel(std::min(1.0f, dot(o, h))) * (d * ggx.g2(o, i));
    if (many()) {
      const float p_many = many_probability(o.z);
      f += many_bounces(o.z, i.z) * i.z;
      pdf += p_glossy * (p_many * i.z * kInvPi + (1 - p_many) * d * ggx.g1(o));
    } else {
      pdf += p_glossy * d * ggx.g1(o);
    }
  }
  return f;
}

Rgb Bsdf::diffuse_share(const Vec3& o, const Vec3& i) const {
  if (lobes_ == kDiffuse || (lobes_ & (kBoundary | kPhase)) != 0) return {1, 1, 1};
  if ((lobes_ & kDiffuse) == 0) return {0, 0, 0};
  float pdf;
  const Rgb all = evaluate(o, i, pdf);
  Rgb part = diffuse(o.z, i.z) * i.z;
  if (has_clear()) part *= through_clear(o.z) * through_clear(i.z);
  Rgb share(0, 0, 0);
  for (int c = 0; c < 3; ++c) {
    if (all[c] > 0) share[c] = std::min(1.0f, part[c] / all[c]);
  }
  return share;
}

bool Bsdf::sample(const Vec3& o, const Vec2& u, float choice, BsdfSample& sample) const {
  if (has_clear()) return sample_clear(o, u, choice, sample);
  if (lobes_ == kBoundary) return sample_boundary(o, u, choice, sample);
  if (lobes_ == kPhase) {
    // z is where the path came from.
    const Vec3 along = sample_phase(mean_cosine_, u);
    sample.direction = Vec3(along.x, along.y, -along.z);
    sample.pdf = phase(mean_cosine_, along.z);
    sample.weight = reflectance_;
    return true;
  }
  if (o.z < kLeastCosine) return false;
  if (lobes_ == kGlass) return sample_glass(o, choice, sample);
  if (lobes_ == kDiffuse && coat_.lower == nullptr) {
    sample.direction = cosine_hemisphere(u);
    sample.weight = reflectance_;
    sample.pdf = sample.direction.z * kInvPi;
    return sample.pdf > 0;
  }
  const float p_glossy = glossy_probability(o);
  if (choice < p_glossy && (lobes_ & kGlossy) != 0) {
    if (alpha_ < kLeastAlpha) {
      sample.direction = Vec3(-o.x, -o.y, o.z);
      sample.weight = glossy_fresnel(o.z) * (1 / p_glossy);
      sample.pdf = 0;
      return true;
    }
    const bool bounces_often = many() && choice < p_glossy * many_probability(o.z);
    sample.direction =
        bounces_often ? cosine_hemisphere(u) : reflect(o, Ggx{alpha_ * alpha_}.sample(o, u));
  } else if (enters()) {
    return sample_into(o, u, 1 - p_glossy, sample);
  } else {
    sample.direction = cosine_hemisphere(u);
  }
  const Rgb f = evaluate(o, sample.direction, sample.pdf);
  if (!(sample.pdf > 0)) return false;
  sample.weight = f * (1 / sample.pdf);
  return true;
}

bool Bsdf::sample_glass(const Vec3& o, float choice, BsdfSample& sample) const {
  sample.pdf = 0;
  const float reflected = fresnel_dielectric(std::min(1.0f, o.z), eta_);
  if (choice < reflected) {
    sample.direction = Vec3(-o.x, -o.y, o.z);
    sample.weight = Rgb(1, 1, 1);
    return true;
  }
  const float inverse = 1 / eta_;
  const float cosine_sq = 1 - (1 - o.z * o.z) * inverse * inverse;
  if (cosine_sq <= 0) return false;
  sample.direction = normalize(Vec3(-o.x * inverse, -o.y * inverse, -std::sqrt(cosine_sq)));
  // Radiance is denser in the denser medium: the camera's path pays here what it got or gets back
  // elsewhere.
  sample.eta_scale = inverse * inverse;
  sample.weight = reflectance_ * sample.eta_scale;
  return true;
}

}  // namespace psf::render
