// Random walks in bodies that are filled with a medium, from one place at the boundary to the next.
#include <bit>

#include "core/interrupt.h"
#include "render/light/medium.h"
#include "render/light/transport.h"

namespace psf::render {
namespace {

// A walk that carries less than this of what it brought in plays Russian roulette.
constexpr float kFaint = 0.1f;
// One that was scattered so often goes on with this probability, and again each time that number has
// doubled. Light that comes back after n events is rare as 1 / sqrt(n) (of a plane surface), so the
// time that long walks take then shrinks with n, and what they weigh grows only as n does.
constexpr std::uint64_t kLong = std::uint64_t{1} << 16;
constexpr float kLongGoesOn = 0.5f;

// What is absorbed has been counted by the walk.
Vertex medium_vertex(const Medium& medium, int material, const Ray& ray) {
  const Surface at = Surface::in_medium(ray, kNone, material);
  return {at,
          Bsdf::of_medium(medium, Rgb(1, 1, 1)),
          Frame(at.normal),
          -ray.direction,
          Vec3(0, 0, 1),
          Media()};
}

// The other side of the surface that a ray met.
Vertex boundary_vertex(Surface surface, const Material& material, const Vec3& direction) {
  surface.geometric_normal = -surface.geometric_normal;
  surface.normal = -surface.normal;
  surface.front = true;
  const Frame frame(surface.normal);
  return {surface,    Bsdf::of_boundary(material), frame,
          -direction, frame.to_local(-direction),  Media()};
}

}  // namespace

std::optional<Vertex> Transport::next_inside(Walk& walk, Sampler& sampler,
                                             std::uint64_t& rays) const {
  const int body = walk.body;
  const Material& material = scene_.materials[static_cast<std::size_t>(body)];
  const Medium& medium = scene_.media[static_cast<std::size_t>(material.interior)];
  const Rgb albedo = medium.albedo();
  const Vec3 start = walk.ray.origin;
  const auto arrive = [&](Vertex v) {
    v.bodies = v.bsdf.everywhere() ? walk.bodies : 0;
    v.media = walk.media;
    if (walk.trail != nullptr) {
      walk.trail->arrive(v.surface, walk.ray.direction,
                         std::sqrt(length_sq(v.surface.position - start)));
    }
    return std::optional(v);
  };
  while (!core::overdue()) {
    Hit hit;
    Rgb weight;
    const Flight flight = fly(medium, walk.ray, walk.within, sampler, weight, [&](float reach) {
      ++rays;
      const bool there =
          accel_.intersect(walk.ray.origin, walk.ray.direction, hit, reach, walk.ray.time);
      return there ? hit.distance : std::numeric_limits<float>::infinity();
    });
    const bool met = !flight.scattered && flight.distance < std::numeric_limits<float>::infinity();
    if (!met) weight = flight.scattered ? weight * albedo : Rgb(0, 0, 0);
    walk.within = walk.within * weight;
    walk.throughput = walk.throughput * weight;
    if (walk.trail != nullptr) walk.trail->attenuate(weight);
    if (is_black(walk.throughput)) return std::nullopt;
    if (met) {
      const Surface surface = shapes_.surface(hit, walk.ray.direction, walk.ray.time);
      if (overlaps(surface, body, walk.bodies)) {
        walk.ray.origin = surface.origin_toward(walk.ray.direction);
        continue;
      }
      // Only its own boundary lets a walk out; what else is in a body absorbs.
      const Material& other = scene_.materials[static_cast<std::size_t>(surface.material)];
      if (other.interior != material.interior || surface.front) return std::nullopt;
      return arrive(boundary_vertex(surface, other, walk.ray.direction));
    }
    walk.ray.origin += walk.ray.direction * flight.distance;
    // Out of the scene there is no way back: the surface was not closed.
    if (!(length_sq(walk.ray.origin - accel_.center()) <=
          1.01f * accel_.radius() * accel_.radius()))
      return std::nullopt;
    if (!survives_inside(walk, sampler)) return std::nullopt;
    if (material.ior == 1) {
      return arrive(medium_vertex(medium, body, walk.ray));
    }
    walk.ray.direction =
        normalize(Frame(walk.ray.direction).to_world(sample_phase(medium.g, sampler.next_2d())));
  }
  return std::nullopt;
}

bool Transport::survives_inside(Walk& walk, Sampler& sampler) {
  ++walk.events;
  const float carried = max_component(walk.within);
  float q = carried < kFaint ? carried / kFaint : 1;
  if (walk.events >= kLong && std::has_single_bit(walk.events)) q *= kLongGoesOn;
  if (q >= 1) return true;
  const bool survived = sampler.next_1d() < q;
  if (walk.trail != nullptr) survived ? walk.trail->survive(1 / q) : walk.trail->end();
  if (!survived) return false;
  walk.within *= 1 / q;
  walk.throughput *= 1 / q;
  return true;
}

bool Transport::overlaps(const Surface& surface, int material, int& bodies) const {
  const auto medium_of = [&](int index) {
    return scene_.materials[static_cast<std::size_t>(index)].interior;
  };
  if (medium_of(surface.material) != medium_of(material)) return false;
  if (surface.front) {
    ++bodies;
    return true;
  }
  if (bodies <= 1) return false;
  --bodies;
  return true;
}

bool Transport::leaves_body(const Vertex& v, const LightSample& sample, Vec3& origin, Rgb& left,
                            Sampler& sampler, std::uint64_t& rays) const {
  const int material = v.surface.material;
  const int interior = scene_.materials[static_cast<std::size_t>(material)].interior;
  const Medium& medium = scene_.media[static_cast<std::size_t>(interior)];
  const float time = v.surface.time;
  int bodies = v.bodies;
  for (;;) {
    float reach = std::numeric_limits<float>::infinity();
    if (!sample.infinite) reach = std::sqrt(length_sq(sample.target - origin));
    ++rays;
    Hit hit;
    const bool met = accel_.intersect(origin, sample.direction, hit, reach * (1 - 0x1p-17f), time);
    const float distance = met ? hit.distance : reach;
    left = left * transmittance(medium, {origin, sample.direction}, distance, sampler);
    if (!met || is_black(left)) return !is_black(left);
    const Surface surface = shapes_.surface(hit, sample.direction, time);
    origin = surface.origin_toward(sample.direction);
    if (overlaps(surface, material, bodies)) continue;
    const Material& other = scene_.materials[static_cast<std::size_t>(surface.material)];
    return other.interior == interior && other.ior == 1 && !surface.front;
  }
}

}  // namespace psf::render
