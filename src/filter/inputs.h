// The inputs of an estimator: required channels, terms, values to average.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "filter/parameters/parameters.h"
#include "filter/records.h"
#include "filter/roles.h"
#include "filter/values.h"

namespace psf::filter {

// Throws Error{bad_input} naming a channel that `parameters` use and `records` do not have.
void require_channels(const Records& records, const Parameters& parameters);

// `terms`, without `gloss` where no vertex has a glossy lobe, since then `gloss` passes every pair.
[[nodiscard]] WeightTerms terms_in_use(const Records& records, const WeightTerms& terms);

// By record number: contribution / rho of the sources; 0 where that is not finite, and for other
// records. `contribution`: c, or that of a layer.
[[nodiscard]] std::vector<Rgb> demodulated(std::span<const Rgb> contribution,
                                           const Records& records, const Roles& roles);

// c_bar_i from the average over `neighbors` sources: multiplied by rho_i under demodulation. A
// source that was averaged over itself alone keeps `own`, c_i, which dividing and multiplying would
// round. Of [density] it is the sum over the area, times the diffuse BSDF; a source without a disk
// keeps `own`.
[[nodiscard]] inline Rgb finished(const Rgb& averaged, std::uint32_t neighbors, bool is_source,
                                  float r_i, const Rgb& own, const Records& records,
                                  std::uint32_t i, const Parameters& parameters) {
  if (info(parameters.estimator).is_of_photons) {
    if (is_source && !(r_i * r_i > 0)) return own;
    return averaged * (records.reflectance[i] * (1 / std::numbers::pi_v<float>));
  }
  const bool is_mean = !info(parameters.estimator).is_over_area || r_i * r_i == 0;
  if (neighbors == 1 && is_source && is_mean) return own;
  return parameters.demodulate ? remodulate(averaged, records.reflectance[i]) : averaged;
}

}  // namespace psf::filter
