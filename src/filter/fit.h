// [fit]: in place of the mean of a ball's contributions, the value at its centre of what is linear in
// place and normal and fits them best.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/vec.h"
#include "filter/records.h"
#include "filter/sum.h"

namespace psf::filter {

inline constexpr std::size_t kFeatures = 4;
inline constexpr std::size_t kFeatureProducts = kFeatures * (kFeatures + 1) / 2;
// Where the product of features k and l <= k is, among all of them.
[[nodiscard]] constexpr std::size_t product_at(std::size_t k, std::size_t l) {
  return k * (k + 1) / 2 + l;
}

// The features of source j as record i sees it: f_k = (x_j - x_i) . place[k] for k < 2, and
// f_(2 + k) = (y_j - y_i) . facing[k], where y is facing().
struct FitAxes {
  Vec3 place[2], facing[2];
};
// y: normals; of vertices in volumes, which have none, positions.
[[nodiscard]] std::span<const Vec3> facing(const Records& records);
// `r_i`: the radius of record i; infinite: places say nothing.
[[nodiscard]] FitAxes fit_axes(const Records& records, std::uint32_t i, float r_i);
// f_ij from x_j - x_i and y_j - y_i.
[[nodiscard]] inline std::array<double, kFeatures> features(const FitAxes& axes, const Vec3& place,
                                                            const Vec3& facing) {
  return {double{dot(place, axes.place[0])}, double{dot(place, axes.place[1])},
          double{dot(facing, axes.facing[0])}, double{dot(facing, axes.facing[1])}};
}

// Sums over the sources in a ball.
struct FitMoments {
  double count = 0;
  double luminance = 0, luminance_sq = 0;  // of what is averaged
  std::array<double, kFeatures> sum{};
  std::array<double, kFeatureProducts> product{};  // f_k f_l at product_at(k, l)

  void add(const std::array<double, kFeatures>& f, double y);
};

// [fit] is the mean plus the sum over j of weight(f_ij) c_j.
struct Fit {
  std::array<double, kFeatures> slope{};
  double at_mean = 0;
  double ridge = std::numeric_limits<double>::infinity();  // lambda_i; infinite: it is the mean

  [[nodiscard]] double weight(const std::array<double, kFeatures>& f) const;
};
[[nodiscard]] Fit fit_of(const FitMoments& moments);

// How far from the mean to the fit each colour may go, from 0 to 1, so that light stays at least 0.
// It is found for the whole light and is the same for its layers, which so add up as before.
class FitShares {
 public:
  // `beside`: fit minus mean.
  FitShares(const Sum& mean, const Sum& beside)
      : x_(share(mean.x, beside.x)), y_(share(mean.y, beside.y)), z_(share(mean.z, beside.z)) {}
  [[nodiscard]] std::array<double, 3> each() const { return {x_, y_, z_}; }
  // The result for the whole light or for a layer of it.
  [[nodiscard]] Rgb taken(const Sum& mean, const Sum& beside) const {
    return {taken(mean.x, beside.x, x_), taken(mean.y, beside.y, y_), taken(mean.z, beside.z, z_)};
  }

 private:
  static double share(double mean, double beside);
  static float taken(double mean, double beside, double share);

  double x_, y_, z_;
};

}  // namespace psf::filter
