// Photons that own their columns, and [density] written a second time: in double, every pair.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "estimator_case.h"
#include "filter/parameters/parameters.h"
#include "oracle.h"
#include "record_set.h"

namespace psf::tests {

struct PhotonSet {
  std::vector<Vec3> position, normal, direction;
  std::vector<Rgb> power;
  std::vector<std::uint32_t> material;
  std::uint32_t passes = 1;

  explicit PhotonSet(std::size_t count)
      : position(count, Vec3(0, 0, 0)),
        normal(count, Vec3(0, 1, 0)),
        direction(count, Vec3(0, 1, 0)),
        power(count, Rgb(1, 1, 1)),
        material(count) {}

  [[nodiscard]] std::size_t size() const { return position.size(); }
  [[nodiscard]] filter::Photons view() const {
    return {position, normal, direction, power, material, passes};
  }
};

// On the lattice of random_records() and with its normals. Some arrive along a surface or from
// behind. Powers are whole numbers, whose sums are exact in any order.
inline PhotonSet random_photons(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto below = [&random](std::uint32_t n) {
    return static_cast<std::uint32_t>(random() % n);
  };
  PhotonSet set(count);
  for (std::size_t p = 0; p < count; ++p) {
    for (int axis = 0; axis < 3; ++axis) set.position[p][axis] = static_cast<float>(below(64)) / 64;
    const float angle = 0.25f * static_cast<float>(below(7));
    set.normal[p] = Vec3(std::cos(angle), std::sin(angle), 0);
    const Vec3 directions[] = {{0, 1, 0}, {1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0.6f, 0.8f, 0}};
    set.direction[p] = directions[below(5)];
    set.power[p] = Rgb(static_cast<float>(1 + below(100)), static_cast<float>(below(7)), 1);
    set.material[p] = below(2);
  }
  set.passes = 2;
  return set;
}

struct DensityResult {
  Triple c{};
  std::size_t neighbors = 0;
};

// [density] at record i of a ball of radius r, from the photons [first, last) of `passes` passes.
inline DensityResult density_at(const RecordSet& set, std::size_t i, double r,
                                const PhotonSet& photons, std::size_t first, std::size_t last,
                                double passes, const filter::WeightTerms& terms) {
  DensityResult result;
  const Triple x = triple(set.position[i]), n = triple(set.normal[i]);
  for (std::size_t p = first; p < last; ++p) {
    const Triple d = minus(triple(photons.position[p]), x);
    if (!(inner(d, d) < r * r) || !(inner(triple(photons.direction[p]), n) > 0)) continue;
    if (terms.normal && inner(triple(photons.normal[p]), n) < double{*terms.normal}) continue;
    if (terms.plane && std::abs(inner(d, n)) > double{*terms.plane} * r) continue;
    if (terms.material && photons.material[p] != set.material[i]) continue;
    ++result.neighbors;
    for (std::size_t k = 0; k < 3; ++k) result.c[k] += triple(photons.power[p])[k];
  }
  const Triple rho = triple(set.reflectance[i]);
  for (std::size_t k = 0; k < 3; ++k) {
    result.c[k] *= rho[k] / std::numbers::pi / (std::numbers::pi * r * r) / passes;
  }
  return result;
}

inline filter::Parameters density_parameters(const filter::WeightTerms& terms, double r0) {
  filter::Parameters parameters;
  parameters.estimator = filter::Estimator::density;
  parameters.weights = terms;
  parameters.radius = {r0, filter::RadiusBasis::world, 0, {}};
  return parameters;
}

inline filter::Records with_photons(const RecordSet& set, const PhotonSet& photons) {
  filter::Records records = set.view();
  records.photons = photons.view();
  return records;
}

inline filter::Estimates run_density(const RecordSet& set, const PhotonSet& photons,
                                     const filter::Parameters& parameters, double n = 1) {
  const filter::Block block{0, n, 1, kCamera};
  const filter::Records records = with_photons(set, photons);
  std::vector<float> radius;
  filter::radii(parameters.radius, records, block, radius);
  return filter::estimate(records, radius, block, parameters);
}

}  // namespace psf::tests
