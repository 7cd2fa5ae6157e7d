// Media that are not the same everywhere: delta tracking of free paths (Woodcock et al. 1965), ratio
// tracking of transmittance (Novak et al. 2014), under the largest density of each cell.
#include "render/light/density_walk.h"
#include "render/light/medium.h"
#include "render/light/medium_channels.h"
#include "render/sample/stream.h"

namespace psf::render {
namespace {

// Below this transmittance a shadow ray plays Russian roulette.
constexpr float kFaintLight = 0.1f;

double exponential(float u) {
  return -std::log1p(-double{u});
}

// Where a ray would meet something if each cell were everywhere as dense as its densest place.
// Calls met(distance, share) at each such place, with the share that is really there; it returns
// whether to go on. `rate`: coefficient of extinction where the density is 1; `first`: number in
// [0, 1) that decides about the first place. Returns the integral of these largest densities as far
// as the ray was followed.
template <class Met>
double follow(const DensityGrid& grid, const Ray& ray, float reach, float rate, float first,
              Stream& numbers, Met met) {
  double length = 0, left = exponential(first) / double{rate};
  for (DensityWalk walk(grid, ray, reach); walk.next();) {
    const double most{walk.most()};
    double at = walk.from();
    while (left <= most * (walk.to() - at)) {
      at += left / most;
      length += left;
      if (!met(at, walk.density(at) / walk.most())) return length;
      left = exponential(numbers.next()) / double{rate};
    }
    const double rest = most * (walk.to() - at);
    left -= rest;
    length += rest;
  }
  return length;
}

// By the balance heuristic over the channels in which the flight could have been sampled: `count`
// places over `length`. The shares that were really there are those of all channels, so they cancel.
Rgb tracked_weight(const Rgb& sigma, const Rgb& choice, int count, double length) {
  if (sigma.x == sigma.y && sigma.y == sigma.z) return Rgb(1, 1, 1);
  double logarithm[3], largest = -std::numeric_limits<double>::infinity();
  for (int c = 0; c < 3; ++c) {
    const double s{sigma[c]};
    logarithm[c] = (count > 0 ? count * std::log(s) : 0) - s * length;
    if (choice[c] > 0) largest = std::max(largest, logarithm[c]);
  }
  double density = 0;
  for (int c = 0; c < 3; ++c) density += double{choice[c]} * std::exp(logarithm[c] - largest);
  Rgb weight;
  for (int c = 0; c < 3; ++c) {
    // A channel that carries nothing may have any weight, an infinite one too.
    weight[c] =
        choice[c] > 0 ? static_cast<float>(std::exp(logarithm[c] - largest) / density) : 0.0f;
  }
  return weight;
}

}  // namespace

Flight track(const Medium& medium, const Ray& ray, const Rgb& carried, float reach,
             Sampler& sampler, Rgb& weight) {
  const Rgb sigma = medium.sigma_t(), choice = channel_choice(carried);
  const Vec2 u = sampler.next_2d();
  Stream numbers(sampler);
  const float rate = sigma[channel_of(choice, u.x)];
  Flight flight{false, reach};
  int count = 0;
  const double length =
      follow(*medium.density, ray, reach, rate, u.y, numbers, [&](double distance, float share) {
        ++count;
        flight.scattered = numbers.next() < share;
        flight.distance = static_cast<float>(distance);
        return !flight.scattered;
      });
  if (!flight.scattered) flight.distance = reach;
  weight = tracked_weight(sigma, choice, count, length);
  return flight;
}

Rgb tracked_transmittance(const Medium& medium, const Ray& ray, float distance, Sampler& sampler) {
  const Rgb sigma = medium.sigma_t();
  const float rate = max_component(sigma);
  Rgb left(1, 1, 1);
  if (!(rate > 0)) return left;
  Stream numbers(sampler);
  const Rgb part = sigma * (1 / rate);
  static_cast<void>(follow(*medium.density, ray, distance, rate, numbers.next(), numbers,
                           [&](double, float share) {
                             left = left * (Rgb(1, 1, 1) - part * share);
                             const float most = max_component(left);
                             if (most >= kFaintLight) return true;
                             const float q = most / kFaintLight;
                             left = numbers.next() < q ? left * (1 / q) : Rgb(0, 0, 0);
                             return !is_black(left);
                           }));
  return left;
}

}  // namespace psf::render
