// All light sources of a scene: sampling, densities, emission.
#include "render/light/lights.h"

#include "render/light/frame.h"

namespace psf::render {

bool Lights::has_extent(std::size_t light) const {
  return light == count() || lights_[light].kind >= Kind::sun;
}

std::size_t Lights::choose(const Receiver& at, float u, float& probability) const {
  if (placed_) return placed_->choose(at, u, probability);
  const std::size_t light = choice_.sample(u);
  probability = choice_.probability(light);
  return light;
}

Rgb Lights::radiance(const Record& light, const Vec2& uv) {
  return light.texture == nullptr ? light.radiance : light.radiance * light.texture->at(uv);
}

Rgb Lights::mean_radiance(const Record& light, const Vec2& uv) {
  const Rgb whole = radiance(light, uv);
  return light.opacity.full() ? whole : whole * light.opacity.at(uv);
}

bool Lights::sample(std::size_t light, const Surface& from, const Receiver& at, const Vec2& u,
                    LightSample& sample) const {
  if (light == count()) {
    sample.direction = sky_.sample(u, sample.pdf);
    if (!(sample.pdf > 0)) return false;
    sample.infinite = true;
    sample.weight = sky_.radiance(sample.direction) * (1 / sample.pdf);
    return true;
  }
  const Record& r = lights_[light];
  switch (r.kind) {
    case Kind::directional:
      sample.direction = r.direction;
      sample.infinite = true;
      sample.weight = r.radiance;
      sample.pdf = 0;
      return true;
    case Kind::sun:
      sample.direction = Frame(r.direction).to_world(uniform_cone(u, r.extent));
      sample.infinite = true;
      sample.pdf = cone_pdf(r.extent);
      sample.weight = r.radiance * (1 / sample.pdf);
      return true;
    case Kind::mesh:
      return sample_mesh(r, from, at, u, sample);
    case Kind::sphere: {
      // On the light itself, rounding must not decide on which side.
      const bool own = from.emitter == static_cast<int>(light);
      if (own && from.front) return false;
      if (r.sphere != nullptr) return sample_sphere(sphere_at(r, from.time), from, own, u, sample);
      return sample_sphere(r, from, own, u, sample);
    }
    case Kind::point:
    case Kind::spot:
      break;
  }
  const Vec3 toward = r.position - from.position;
  const float distance_sq = length_sq(toward);
  if (!(distance_sq > 0)) return false;
  sample.direction = toward * (1 / std::sqrt(distance_sq));
  sample.target = r.position;
  sample.infinite = false;
  sample.weight = r.radiance * (1 / distance_sq);
  sample.pdf = 0;
  if (r.kind == Kind::spot) {
    const float share = spot_share(r, -dot(sample.direction, r.direction));
    if (!(share > 0)) return false;
    sample.weight *= share;
  }
  return true;
}

float Lights::spot_share(const Record& light, float cosine) {
  if (cosine <= light.cos_outer) return 0;
  if (cosine >= light.cos_inner) return 1;
  const float t = (cosine - light.cos_outer) / (light.cos_inner - light.cos_outer);
  return t * t * (3 - 2 * t);
}

Vec2 Lights::texture_point(const Record& light, std::size_t triangle, float b1, float b2) const {
  const bool plain = light.texture == nullptr && light.opacity.full();
  if (plain || light.mesh->uvs.empty()) return {b1, b2};
  const auto& [a, b, c] = light.mesh->triangles[triangle];
  return light.mesh->uvs[a] * (1 - b1 - b2) + light.mesh->uvs[b] * b1 + light.mesh->uvs[c] * b2;
}

bool Lights::sample_mesh(const Record& light, const Surface& from, const Receiver& at, Vec2 u,
                         LightSample& sample) const {
  std::size_t k;
  const float density = choose_triangle(light, at, u.x, k);
  if (!(density > 0)) return false;
  float stretch = 1;
  const Triangle triangle = light.mesh->motion.empty() ? triangles_[light.first + k]
                                                       : triangle_at(light, k, from.time, stretch);
  const float root = std::sqrt(u.x), b1 = root * (1 - u.y), b2 = root * u.y;
  const Vec3 point = triangle.corner + triangle.edge1 * b1 + triangle.edge2 * b2;
  const Vec3 toward = point - from.position;
  const float distance_sq = length_sq(toward);
  if (!(distance_sq > 0)) return false;
  sample.direction = toward * (1 / std::sqrt(distance_sq));
  float cosine = -dot(sample.direction, triangle.normal);
  const float side = cosine > 0 ? 1.0f : -1.0f;
  if (side < 0 && !light.both_sides) return false;
  cosine *= side;
  sample.pdf = distance_sq * density / (stretch * cosine);
  if (!(cosine > 0) || !std::isfinite(sample.pdf)) return false;
  sample.target = point + triangle.normal * (side * triangle.offset);
  sample.infinite = false;
  sample.weight = mean_radiance(light, texture_point(light, k, b1, b2)) * (1 / sample.pdf);
  return true;
}

bool Lights::sample_sphere(const Record& light, const Surface& from, bool own, const Vec2& u,
                           LightSample& sample) {
  const Vec3 to_center = light.position - from.position;
  const float distance_sq = length_sq(to_center), radius = light.extent;
  const float radius_sq = radius * radius;
  const bool inside = own || distance_sq <= radius_sq;
  sample.pdf = sphere_pdf(light, from.position, inside);
  sample.infinite = false;
  Vec3 normal;
  float side = 1;
  if (inside) {
    if (!light.both_sides) return false;
    sample.direction = uniform_sphere(u);
    const float along = dot(to_center, sample.direction);
    const float reach = along + std::sqrt(std::max(0.0f, along * along + radius_sq - distance_sq));
    normal = normalize(sample.direction * reach - to_center);
    side = -1;
  } else {
    const float distance = std::sqrt(distance_sq);
    const Vec3 axis = to_center * (1 / distance);
    const Vec3 local = uniform_cone(u, one_minus_cos(radius_sq / distance_sq));
    const Frame frame(axis);
    sample.direction = frame.to_world(local);
    // The nearer crossing: its distance from the axis' foot, by the chord's half length.
    const float sine_sq = local.x * local.x + local.y * local.y;
    const float half_chord = std::sqrt(std::max(0.0f, radius_sq - distance_sq * sine_sq));
    normal = normalize(sample.direction * (distance * local.z - half_chord) - to_center);
  }
  const float offset = (max_abs(light.position) + radius) * kOffsetScale;
  sample.target = light.position + normal * (radius + side * offset);
  sample.weight = mean_radiance(light, direction_to_uv(normal)) * (1 / sample.pdf);
  return true;
}

float Lights::sphere_pdf(const Record& light, const Vec3& from, bool inside) {
  if (inside) return 0.25f * kInvPi;
  const float sine_sq = light.extent * light.extent / length_sq(light.position - from);
  return cone_pdf(one_minus_cos(std::min(1.0f, sine_sq)));
}

float Lights::expected(const Arrival& arrival, std::size_t light) const {
  if (arrival.sampled == Sampled::every) return 1;
  if (arrival.sampled == Sampled::strong) return placed_->expected(arrival.from, light);
  return placed_ ? placed_->probability(arrival.from, light) : choice_.probability(light);
}

float Lights::weight(const Arrival& arrival, std::size_t light, float pdf) const {
  if (!(arrival.pdf > 0)) return 1;
  const float chosen = expected(arrival, light);
  return chosen > 0 ? mis_weight(arrival.pdf, pdf * chosen) : 1.0f;
}

Rgb Lights::emitted(const Arrival& arrival, const Surface& hit) const {
  const auto light = static_cast<std::size_t>(hit.emitter);
  const Record& r = lights_[light];
  if (!hit.front && !r.both_sides) return {0, 0, 0};
  float pdf = 0;
  if (arrival.pdf > 0) {
    if (r.kind == Kind::sphere) {
      const Vec3& from = arrival.from.position;
      pdf = r.sphere != nullptr ? sphere_pdf(sphere_at(r, hit.time), from, !hit.front)
                                : sphere_pdf(r, from, !hit.front);
    } else {
      const float cosine = -dot(arrival.direction, hit.geometric_normal);
      const float density = r.tree == kNone
                                ? r.extent
                                : area_density(r, hit.primitive,
                                               trees_[static_cast<std::size_t>(r.tree)].probability(
                                                   arrival.from, hit.primitive));
      pdf = length_sq(hit.position - arrival.from.position) * density /
            (hit.stretch * std::max(cosine, 1e-20f));
    }
  }
  return radiance(r, hit.uv) * weight(arrival, light, pdf);
}

Rgb Lights::from_sky(const Arrival& arrival) const {
  Rgb radiance = sky_.radiance(arrival.direction);
  if (sky_.sampled() && arrival.pdf > 0) {
    radiance *= weight(arrival, count(), sky_.pdf(arrival.direction));
  }
  return radiance;
}

Rgb Lights::from_sun(const Arrival& arrival, std::size_t sun) const {
  const Record& r = lights_[sun];
  // 1 - cos of the angle between, without cancellation.
  if (0.5f * length_sq(arrival.direction - r.direction) > r.extent) return {0, 0, 0};
  return r.radiance * weight(arrival, sun, cone_pdf(r.extent));
}

}  // namespace psf::render
