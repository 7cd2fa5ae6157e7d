// Media that are the same everywhere: free paths and transmittance. Scattering in all media.
#include "render/light/medium.h"

#include "render/light/medium_channels.h"

namespace psf::render {
namespace {

Rgb left_after(const Rgb& sigma, float distance) {
  // 0 * infinity is no number, where a channel does not interact.
  const auto left = [&](float s) { return s > 0 ? std::exp(-s * distance) : 1.0f; };
  return {left(sigma.x), left(sigma.y), left(sigma.z)};
}

float sum_of(const Rgb& c) {
  return c.x + c.y + c.z;
}

}  // namespace

float sample_distance(const Medium& medium, const Rgb& carried, Sampler& sampler) {
  const Rgb choice = channel_choice(carried), sigma = medium.sigma_t();
  const Vec2 u = sampler.next_2d();
  const int channel = channel_of(choice, u.x);
  return sigma[channel] > 0 ? -std::log1p(-u.y) / sigma[channel]
                            : std::numeric_limits<float>::infinity();
}

Rgb flight_weight(const Medium& medium, const Rgb& carried, const Flight& flight) {
  const Rgb sigma = medium.sigma_t(), left = left_after(sigma, flight.distance);
  const Rgb choice = channel_choice(carried);
  const float density = sum_of(flight.scattered ? choice * sigma * left : choice * left);
  // So far that nothing is left in single precision.
  if (!(density > 0)) return {0, 0, 0};
  return (flight.scattered ? sigma * left : left) * (1 / density);
}

Rgb transmittance(const Medium& medium, const Ray& ray, float distance, Sampler& sampler) {
  if (medium.density != nullptr) return tracked_transmittance(medium, ray, distance, sampler);
  return left_after(medium.sigma_t(), distance);
}

Vec3 sample_phase(float g, const Vec2& u) {
  float cosine = 1 - 2 * u.y;
  if (std::abs(g) > 1e-3f) {
    const float s = (1 - g * g) / (1 + g * cosine);
    cosine = std::clamp((1 + g * g - s * s) / (2 * g), -1.0f, 1.0f);
  }
  return around_axis(u.x, 1 - cosine * cosine, cosine);
}

Rgb body_albedo(const Medium& medium, float ior) {
  const float inside = std::clamp(
      ior > 1 ? -1.4399f / (ior * ior) + 0.7099f / ior + 0.6681f + 0.0636f * ior : 0, 0.0f, 0.97f);
  Rgb albedo(0, 0, 0);
  for (int c = 0; c < 3; ++c) {
    if (!(medium.sigma_s[c] > 0)) continue;
    // What is scattered straight on has no part in it.
    const float scattering = medium.sigma_s[c] * (1 - medium.g);
    const float s = std::sqrt(medium.sigma_a[c] / (medium.sigma_a[c] + scattering));
    const float reflected = (1 - s) * (1 - 0.139f * s) / (1 + 1.17f * s);
    albedo[c] = reflected * (1 - inside) / (1 - reflected * inside);
  }
  return albedo;
}

}  // namespace psf::render
