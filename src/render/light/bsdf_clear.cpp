// A clear coat above all that a coat material has.
#include "render/light/bsdf.h"

namespace psf::render {
namespace {

constexpr float kAlongSurface = 1e-7f;  // as for the lobes beneath

}  // namespace

void Bsdf::set_clear(const Material& material, const Scene& scene, const Vec2& uv,
                     const CoatAlbedo& table) {
  const auto texel = [&](int index) {
    return index == kNone ? Rgb(1, 1, 1) : scene.textures[static_cast<std::size_t>(index)].at(uv);
  };
  clear_ = std::clamp(material.clearcoat * texel(material.clearcoat_texture).x, 0.0f, 1.0f);
  if (!(clear_ > 0)) return;
  clear_roughness_ = std::clamp(
      material.clearcoat_roughness * texel(material.clearcoat_roughness_texture).y, 0.0f, 1.0f);
  clear_alpha_ = clear_roughness_ * clear_roughness_;
  clear_row_ = table.row(clear_roughness_);
  lobes_ |= kClear;
}

Bsdf Bsdf::beneath() const {
  Bsdf base = *this;
  base.lobes_ = static_cast<std::uint8_t>(lobes_ & ~kClear);
  base.clear_row_ = {};
  return base;
}

float Bsdf::roughest() const {
  if ((lobes_ & kDiffuse) != 0) return 1;
  return std::max((lobes_ & kGlossy) != 0 ? alpha_ : 0.0f,
                  (lobes_ & kClear) != 0 ? clear_alpha_ : 0.0f);
}

float Bsdf::clear_probability(const Vec3& o) const {
  if ((lobes_ & kClear) == 0) return 0;
  if (lobes_ == kClear) return 1;
  const float clear = 1 - through_clear(o.z);
  const float base = (1 - clear) * luminance(beneath().albedo());
  return clear + base > 0 ? std::clamp(clear / (clear + base), 0.05f, 0.95f) : 0.5f;
}

Rgb Bsdf::clear_albedo() const {
  const float reflected = clear_ * fresnel_dielectric(1, kClearIor);
  Rgb sum(0, 0, 0);
  if ((lobes_ & kClear) != 0) sum = Rgb(reflected, reflected, reflected);
  const Bsdf base = beneath();
  return base.lobes_ == 0 ? sum : sum + base.albedo() * (1 - reflected);
}

Rgb Bsdf::evaluate_clear(const Vec3& o, const Vec3& i, float& pdf) const {
  pdf = 0;
  Rgb f(0, 0, 0);
  if (o.z < kAlongSurface || i.z <= 0) return f;
  const float p_clear = clear_probability(o);
  const Bsdf base = beneath();
  if (base.lobes_ != 0) {
    f = base.evaluate(o, i, pdf) * (through_clear(o.z) * through_clear(i.z));
    pdf *= 1 - p_clear;
  }
  if ((lobes_ & kClear) != 0 && clear_alpha_ >= kLeastAlpha) {
    const Ggx ggx{clear_alpha_ * clear_alpha_};
    const Vec3 h = normalize(o + i);
    const float d = ggx.d(h) / (4 * o.z);
    const float reflected = clear_ * fresnel_dielectric(std::min(1.0f, dot(o, h)), kClearIor) * d;
    f += Rgb(reflected * ggx.g2(o, i));
    pdf += p_clear * d * ggx.g1(o);
  }
  return f;
}

bool Bsdf::sample_clear(const Vec3& o, const Vec2& u, float choice, BsdfSample& sample) const {
  if (o.z < kAlongSurface) return false;
  const float p_clear = clear_probability(o);
  if (choice < p_clear) {
    if (clear_alpha_ < kLeastAlpha) {
      sample.direction = Vec3(-o.x, -o.y, o.z);
      sample.weight = Rgb(clear_ * fresnel_dielectric(o.z, kClearIor) / p_clear);
      sample.pdf = 0;
      return true;
    }
    sample.direction = reflect(o, Ggx{clear_alpha_ * clear_alpha_}.sample(o, u));
  } else {
    const float left = std::min((choice - p_clear) / (1 - p_clear), 0x1.fffffep-1f);
    if (!beneath().sample(o, u, left, sample)) return false;
    if (sample.pdf == 0) {
      sample.weight *= through_clear(o.z) * through_clear(sample.direction.z) / (1 - p_clear);
      return true;
    }
  }
  const Rgb f = evaluate_clear(o, sample.direction, sample.pdf);
  if (!(sample.pdf > 0)) return false;
  sample.weight = f * (1 / sample.pdf);
  return true;
}

}  // namespace psf::render
