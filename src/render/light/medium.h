// Light in a medium: how far it goes, and whither it is scattered. Whatever knows a medium's
// coefficients at a place is here, so that one which is not the same everywhere needs new functions
// of these names, with the ray and the sampler that they already get, and nothing else.
#pragma once

#include "render/light/frame.h"
#include "render/light/integrator.h"
#include "render/sample/sampler.h"
#include "render/scene/medium.h"

namespace psf::render {

// Where a ray ends in a medium.
struct Flight {
  bool scattered;  // before `reach`
  float distance;  // where it is scattered, or `reach`
};

// Samples how far `ray` goes, in one channel of the three; infinity where that does not interact.
// The probabilities of the channels are as `carried`, what the path carries so far.
[[nodiscard]] float sample_distance(const Medium& medium, const Ray& ray, const Rgb& carried,
                                    Sampler& sampler);
// By what the path is multiplied after this flight, by the balance heuristic over the channels that
// could have been chosen: transmittance, and the coefficient of meeting something where it was
// scattered, over the density of the distance, or the probability of going so far. The albedo is
// still to come.
[[nodiscard]] Rgb flight_weight(const Medium& medium, const Ray& ray, const Rgb& carried,
                                const Flight& flight);
// What of the light is left after `distance`.
[[nodiscard]] Rgb transmittance(const Medium& medium, const Ray& ray, float distance,
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
