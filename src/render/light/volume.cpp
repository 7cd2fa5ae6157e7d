// Media between the surfaces: where a walk is scattered in them, and what of a light they let through.
#include <algorithm>

#include "render/light/lit_stretch.h"
#include "render/light/medium.h"
#include "render/light/medium_channels.h"
#include "render/light/transport.h"

namespace psf::render {
namespace {

bool has_place(const Light& light) {
  return light.kind != LightKind::directional;
}

// How many of the free paths that may meet a light are sampled by it.
constexpr float kByLight = 0.5f;

// fly() in a medium that is the same everywhere, where the distance may also be sampled by a light
// without extent. Both ways are combined by the balance heuristic, given the light.
template <class Nearest>
Flight fly_by_light(const Medium& medium, const std::vector<Light>& lights, const Ray& ray,
                    const Rgb& carried, Sampler& sampler, Rgb& weight, Nearest nearest) {
  const float surface = nearest(RayCaster::kEndless);
  const Vec2 u = sampler.next_2d();
  const auto count = static_cast<float>(lights.size());
  const auto light = std::min(lights.size() - 1, static_cast<std::size_t>(u.x * count));
  const LitStretch stretch(lights[light], ray, surface);
  const float by_light = stretch.empty() ? 0 : kByLight;
  const float distance = u.y < by_light ? stretch.sample(sampler.next_2d().x)
                                        : sample_distance(medium, carried, sampler);
  const Flight flight{distance < surface, std::min(distance, surface)};
  const Rgb sigma = medium.sigma_t(), choice = channel_choice(carried);
  Rgb left = transmittance(medium, ray, flight.distance, sampler);
  if (flight.scattered) left = left * sigma;
  const Rgb chosen = choice * left;
  float density = (1 - by_light) * (chosen.x + chosen.y + chosen.z);
  if (flight.scattered && by_light > 0) density += by_light * stretch.density(flight.distance);
  weight = density > 0 ? left * (1 / density) : Rgb(0, 0, 0);
  return flight;
}

}  // namespace

bool Transport::crosses(const Surface& surface, Media& media) const {
  const Material& material = scene_.materials[static_cast<std::size_t>(surface.material)];
  if (material.kind != MaterialKind::volume) return false;
  surface.front ? media.enter(material.interior) : media.leave();
  return true;
}

bool Transport::meets(Ray ray, float reach, Sampler& sampler, Hit& hit, std::uint64_t& rays) const {
  float before = 0;
  while (caster_.nearest(ray.origin, ray.direction, reach - before, ray.time, sampler, hit, rays)) {
    hit.distance += before;
    if (!has_volumes_) return true;
    const Surface surface = shapes_.surface(hit, ray.direction, ray.time);
    Media unused;
    if (!crosses(surface, unused)) return true;
    before = hit.distance;
    ray.origin = surface.origin_toward(ray.direction);
  }
  return false;
}

float Transport::arrive(Walk& walk, Surface& surface, Sampler& sampler, std::uint64_t& rays) const {
  if (!has_volumes_) return next_surface(walk, surface, sampler, rays);
  constexpr float kUnbounded = std::numeric_limits<float>::infinity();
  float before = 0;
  for (;;) {
    const int medium = walk.media.now();
    Hit hit;
    const auto nearest = [&](float reach) {
      return caster_.nearest(walk.ray.origin, walk.ray.direction, reach, walk.ray.time, sampler,
                             hit, rays)
                 ? hit.distance
                 : kUnbounded;
    };
    Flight flight{false, kUnbounded};
    if (medium == kNone) {
      flight.distance = nearest(kUnbounded);
    } else {
      Rgb weight;
      const Medium& in = scene_.media[static_cast<std::size_t>(medium)];
      // Of many lights the one that is chosen is seldom the one that matters.
      const bool by_light = in.density == nullptr && lights_.count() <= Lights::kEveryLight &&
                            std::any_of(scene_.lights.begin(), scene_.lights.end(), has_place);
      flight = by_light ? fly_by_light(in, scene_.lights, walk.ray, walk.throughput, sampler,
                                       weight, nearest)
                        : fly(in, walk.ray, walk.throughput, sampler, weight, nearest);
      walk.throughput = walk.throughput * weight;
    }
    if (flight.scattered) {
      Ray there = walk.ray;
      there.origin += there.direction * flight.distance;
      surface =
          Surface::in_medium(there, medium, static_cast<int>(scene_.materials.size()) + medium);
      return before + flight.distance;
    }
    if (!(flight.distance < kUnbounded)) return kUnbounded;
    surface = shapes_.surface(hit, walk.ray.direction, walk.ray.time);
    before += hit.distance;
    if (!crosses(surface, walk.media)) return before;
    walk.ray.origin = surface.origin_toward(walk.ray.direction);
  }
}

float Transport::shines(Vec3 origin, const LightSample& sample, float time, Media media, Rgb& left,
                        Sampler& sampler, std::uint64_t& rays) const {
  // Both ends lie off their surfaces; stopping a hair short keeps rounding from reaching the
  // light's own.
  constexpr float kShort = 1 - 0x1p-17f, kUnbounded = RayCaster::kEndless;
  if (!has_volumes_) {
    return sample.infinite
               ? caster_.transmittance(origin, sample.direction, kUnbounded, time, rays)
               : caster_.transmittance(origin, sample.target - origin, kShort, time, rays);
  }
  float share = 1;
  for (;;) {
    const float reach = sample.infinite ? kUnbounded : std::sqrt(length_sq(sample.target - origin));
    ++rays;
    Hit hit;
    const bool met = accel_.intersect(origin, sample.direction, hit, reach * kShort, time);
    if (media.now() != kNone) {
      const Medium& medium = scene_.media[static_cast<std::size_t>(media.now())];
      const float distance = met ? hit.distance : reach;
      left = left * transmittance(medium, {origin, sample.direction}, distance, sampler);
      if (is_black(left)) return 0;
    }
    if (!met) return share;
    const Surface surface = shapes_.surface(hit, sample.direction, time);
    if (!crosses(surface, media)) share *= caster_.passed(surface);
    if (!(share > 0)) return 0;
    origin = surface.origin_toward(sample.direction);
  }
}

}  // namespace psf::render
