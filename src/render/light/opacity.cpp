// Rays through masks and blended surfaces: the same ray, from behind each that is passed.
#include "render/light/opacity.h"

#include <algorithm>

#include "render/light/frame.h"
#include "render/sample/sampler.h"

namespace psf::render {

Opacity Opacity::of(const Material& material, const Scene& scene) {
  const int index = material.opacity_texture;
  return {material.opacity,
          index == kNone ? nullptr : &scene.textures[static_cast<std::size_t>(index)],
          material.opacity_cutoff};
}

float RayCaster::opacity_of(const Surface& surface) const {
  return opacities_[static_cast<std::size_t>(surface.material)].at(surface.uv);
}

float RayCaster::behind(const Hit& hit, const Surface& surface) {
  return std::max(hit.distance + surface.offset, std::nextafter(hit.distance, kEndless));
}

float Opacity::at(const Vec2& uv) const {
  const float opacity = texture == nullptr ? factor : factor * texture->at(uv).x;
  if (cutoff > 0) return opacity >= cutoff ? 1.0f : 0.0f;
  return std::clamp(opacity, 0.0f, 1.0f);
}

RayCaster::RayCaster(const Scene& scene, const Accel& accel, const Shapes& shapes)
    : accel_(accel), shapes_(shapes) {
  for (const Material& m : scene.materials) opacities_.push_back(Opacity::of(m, scene));
  if (std::ranges::all_of(opacities_, &Opacity::full)) opacities_.clear();
}

bool RayCaster::nearest(const Vec3& origin, const Vec3& direction, float reach, float time,
                        Sampler& sampler, Hit& hit, std::uint64_t& rays) const {
  float beyond = 0;
  for (int passed = 0;; ++passed) {
    ++rays;
    if (!accel_.intersect(origin, direction, hit, reach, time, beyond)) return false;
    if (opacities_.empty() || passed == kMostPassed) return true;
    const Surface surface = shapes_.surface(hit, direction, time);
    const float opacity = opacity_of(surface);
    if (opacity >= 1 || (opacity > 0 && sampler.next_1d() < opacity)) return true;
    beyond = behind(hit, surface);
  }
}

float RayCaster::transmittance(const Vec3& origin, const Vec3& direction, float reach, float time,
                               std::uint64_t& rays) const {
  if (opacities_.empty()) {
    ++rays;
    return accel_.occluded(origin, direction, reach, time) ? 0.0f : 1.0f;
  }
  const float length = std::sqrt(length_sq(direction));
  const Vec3 unit = direction * (1 / length);
  float beyond = 0, share = 1;
  for (int passed = 0;; ++passed) {
    Hit hit;
    ++rays;
    if (!accel_.intersect(origin, unit, hit, reach * length, time, beyond)) return share;
    const Surface surface = shapes_.surface(hit, unit, time);
    share *= 1 - opacity_of(surface);
    if (!(share > 0) || passed == kMostPassed) return 0;
    beyond = behind(hit, surface);
  }
}

}  // namespace psf::render
