#include "filter/scaled.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.h"

namespace psf::filter {
namespace {

constexpr std::size_t kScaledGrain = 1 << 14;
constexpr int kLargestExponent =
    58;                            // exponent: twelve squares of it, a box's diagonal, are finite
constexpr int kLeastExtent = -20;  // exponent: there is room below it for radii without digits lost
constexpr int kFinite = 125;       // exponent: differences of coordinates are finite

// Extreme lengths of all vertices whose position is finite; only such vertices are compared.
struct Extremes {
  float coordinate = 0, distance = 0;  // largest absolute values
  float least_radius = std::numeric_limits<float>::infinity(), largest_radius = 0;  // radii > 0

  void operator+=(const Extremes& other) {
    coordinate = std::max(coordinate, other.coordinate);
    distance = std::max(distance, other.distance);
    least_radius = std::min(least_radius, other.least_radius);
    largest_radius = std::max(largest_radius, other.largest_radius);
  }
};

Extremes extremes_of(const Records& records, std::span<const float> radius) {
  std::vector<Extremes> parts(core::range_count(records.size(), kScaledGrain));
  core::parallel_for(records.size(), kScaledGrain, [&](std::size_t begin, std::size_t end) {
    Extremes& part = parts[begin / kScaledGrain];
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& x = records.position[i];
      if ((records.flags[i] & kHasVertex) == 0 || !is_finite(x)) continue;
      part.coordinate = std::max({part.coordinate, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
      if (!records.distance.empty() && std::isfinite(records.distance[i])) {
        part.distance = std::max(part.distance, std::abs(records.distance[i]));
      }
      const float r_i = radius[i];
      if (!(r_i > 0) || std::isinf(r_i)) continue;
      part.least_radius = std::min(part.least_radius, r_i);
      part.largest_radius = std::max(part.largest_radius, r_i);
    }
  });
  Extremes all;
  for (const Extremes& part : parts) all += part;
  for (const Vec3& x : records.photons.position) {
    if (!is_finite(x)) continue;
    all.coordinate = std::max({all.coordinate, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  }
  return all;
}

// 0 where the lengths are right as they are; none where no unit is right for all.
std::optional<int> exponent_for(const Extremes& e, double least_share) {
  if (!(e.coordinate > 0)) return 0;
  const int extent = std::ilogb(e.coordinate);
  int low = -kFinite - extent, high = kFinite - extent;
  if (e.distance > 0) high = std::min(high, kFinite - std::ilogb(e.distance));
  if (e.largest_radius > 0) {
    low = std::max(low, -kLargestExponent - std::ilogb(double{e.least_radius} * least_share));
    high = std::min(high, kLargestExponent - std::ilogb(e.largest_radius));
  }
  if (low > high) return std::nullopt;
  // The places of orphans count too, and what all searches do with large coordinates.
  const bool is_moderate = extent >= kLeastExtent && extent <= kLargestExponent;
  if (is_moderate && low <= 0 && 0 <= high) return 0;
  return std::clamp(-extent, low, high);
}

template <class T>
std::vector<T> by_power_of_two(std::span<const T> vectors, int exponent) {
  std::vector<T> scaled;
  scaled.reserve(vectors.size());
  for (const T& v : vectors) {
    scaled.emplace_back(std::ldexp(v.x, exponent), std::ldexp(v.y, exponent),
                        std::ldexp(v.z, exponent));
  }
  return scaled;
}

}  // namespace

Scaled::Scaled(const Records& records, std::span<const float> radius, double least_share)
    : records_(records), radius_(radius) {
  const std::optional<int> exponent = exponent_for(extremes_of(records, radius), least_share);
  fits_ = exponent.has_value();
  exponent_ = exponent.value_or(0);
  if (exponent_ == 0) return;
  const auto scaled = [this](std::span<const float> from, std::vector<float>& to) {
    to.resize(from.size());
    std::transform(from.begin(), from.end(), to.begin(),
                   [this](float length) { return from_world(length); });
  };
  scaled(radius, radii_);
  scaled(records.distance, distances_);
  positions_ = by_power_of_two(records.position, exponent_);
  photon_positions_ = by_power_of_two(records.photons.position, exponent_);
  powers_ = by_power_of_two(records.photons.power, 2 * exponent_);
  radius_ = radii_;
  records_.distance = distances_;
  records_.position = positions_;
  records_.photons.position = photon_positions_;
  records_.photons.power = powers_;
}

float Scaled::to_world(float length) const {
  return std::ldexp(length, -exponent_);
}
float Scaled::from_world(float length) const {
  return std::ldexp(length, exponent_);
}

}  // namespace psf::filter
