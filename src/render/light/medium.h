// Light in a medium: how far it goes, and whither it is scattered. Whatever knows a medium's
// coefficients at a place is here.
#pragma once

#include "render/light/frame.h"
#include "render/light/integrator.h"
#include "render/sample/sampler.h"
#include "render/scene/medium.h"

namespace psf::render {

// Where a ray ends in a medium.
struct Flight {
  bool scattered;  // before a surface
  float distance;  // where it is scattered, or that of the surface
};

// Of a medium that is the same everywhere: samples how far a ray goes, in one channel of the three;
// infinity where that does not interact. The probabilities of the channels are as `carried`, what the
// path carries so far.
[[nodiscard]] float sample_distance(const Medium& medium, const Rgb& carried, Sampler& sampler);
// By what the path is multiplied after this flight, by the balance heuristic over the channels that
// could have been chosen: transmittance, and the coefficient of meeting something where it was
// scattered, over the density of the distance, or the probability of going so far. The albedo is
// still to come.
[[nodiscard]] Rgb flight_weight(const Medium& medium, const Rgb& carried, const Flight& flight);
// Both, of a medium with a density, up to a surface at `reach`, or nowhere at infinity.
[[nodiscard]] Flight track(const Medium& medium, const Ray& ray, const Rgb& carried, float reach,
                           Sampler& sampler, Rgb& weight);

// The same for every medium. `nearest(reach)` finds the surface that the ray meets within `reach` and
// returns its distance, infinity where there is none. Sets `weight` to that of the flight.
template <class Nearest>
[[nodiscard]] Flight fly(const Medium& medium, const Ray& ray, const Rgb& carried, Sampler& sampler,
                         Rgb& weight, Nearest nearest) {
  constexpr float kUnbounded = std::numeric_limits<float>::infinity();
  if (medium.density != nullptr) {
    return track(medium, ray, carried, nearest(kUnbounded), sampler, weight);
  }
  const float sampled = sample_distance(medium, carried, sampler);
  const float surface = nearest(sampled);
  const bool met = surface < kUnbounded;
  const Flight flight{!met && sampled < kUnbounded, met ? surface : sampled};
  weight = flight_weight(medium, carried, flight);
  return flight;
}

// What of the light is left after `distance`; of a medium with a density an estimate without bias.
[[nodiscard]] Rgb transmittance(const Medium& medium, const Ray& ray, float distance,
                                Sampler& sampler);
[[nodiscard]] Rgb tracked_transmittance(const Medium& medium, const Ray& ray, float distance,
                                        Sampler& sampler);

// The phase function of Henyey and Greenstein, per solid angle: `cosine` is that of the angle by
// which light is turned.
[[nodiscard]] inline float phase(float g, float cosine) {
  const float d = 1 + g * g - 2 * g * cosine;
  return 0.25f * kInvPi * (1 - g * g) / (d * std::sqrt(d));
}
// A direction with that density around +z, along which light travels.
[[nodiscard]] Vec3 sample_phase(float g, const Vec2& u);

// What a body of this medium reflects of diffuse light, as a colour: van de Hulst's approximation
// for the half-space (1980) behind a boundary of index `ior`, whose reflectance from inside for
// diffuse light is the polynomial of Egan and Hilgeman (1973).
[[nodiscard]] Rgb body_albedo(const Medium& medium, float ior);

}  // namespace psf::render
