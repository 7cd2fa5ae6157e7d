#include "filter/fit.h"

#include <algorithm>
#include <cmath>

namespace psf::filter {
namespace {

// A normal that differs by 1/5 counts as much as a place at the edge of the ball.
constexpr float kNormalScale = 5;
// The least ridge. Where all sources lie off the centre, weights are differences of numbers up to
// its inverse, in float.
constexpr double kLeastRidge = 1e-2;

// Solves matrix x = right by its decomposition into L D L^T. `matrix`: by product_at(); its
// eigenvalues are at least `least` but for rounding.
std::array<double, kFeatures> solve(std::array<double, kFeatureProducts> matrix,
                                    std::array<double, kFeatures> right, double least) {
  std::array<double, kFeatures> inverse;  // of D
  for (std::size_t k = 0; k < kFeatures; ++k) {
    double pivot = matrix[product_at(k, k)];
    for (std::size_t l = 0; l < k; ++l) {
      double& below = matrix[product_at(k, l)];  // L D, then L
      for (std::size_t m = 0; m < l; ++m)
        below -= matrix[product_at(k, m)] * matrix[product_at(m, m)] * matrix[product_at(l, m)];
      const double scaled = below;
      below *= inverse[l];
      pivot -= scaled * below;
      right[k] -= below * right[l];
    }
    matrix[product_at(k, k)] = std::max(pivot, least);
    inverse[k] = 1 / matrix[product_at(k, k)];
  }
  for (std::size_t k = kFeatures; k-- > 0;) {
    right[k] *= inverse[k];
    for (std::size_t l = k + 1; l < kFeatures; ++l) right[k] -= matrix[product_at(l, k)] * right[l];
  }
  return right;
}

}  // namespace

std::span<const Vec3> facing(const Records& records) {
  return records.taken == Taken::volumes ? records.position : records.normal;
}

FitAxes fit_axes(const Records& records, std::uint32_t i, float r_i) {
  const float scale = r_i > 0 ? 1 / r_i : 0;
  if (records.taken == Taken::volumes) {
    return {{Vec3(scale, 0, 0), Vec3(0, scale, 0)}, {Vec3(0, 0, scale), Vec3(0, 0, 0)}};
  }
  Vec3 s, t;
  complete_basis(records.normal[i], s, t);
  return {{s * scale, t * scale}, {s * kNormalScale, t * kNormalScale}};
}

void FitMoments::add(const std::array<double, kFeatures>& f, double y) {
  ++count;
  luminance += y;
  luminance_sq += y * y;
  for (std::size_t k = 0; k < kFeatures; ++k) {
    sum[k] += f[k];
    for (std::size_t l = 0; l <= k; ++l) product[product_at(k, l)] += f[k] * f[l];
  }
}

double Fit::weight(const std::array<double, kFeatures>& f) const {
  double weight = at_mean;
  for (std::size_t k = 0; k < kFeatures; ++k) weight -= slope[k] * f[k];
  return weight;
}

double FitShares::share(double mean, double beside) {
  const double fit = mean + beside;
  if (!std::isfinite(fit)) return 0;
  // A hair less, so that rounding does not go below 0.
  return fit < 0 && mean >= 0 ? (1 - 0x1p-50) * (mean / -beside) : 1;
}

float FitShares::taken(double mean, double beside, double share) {
  const double fit = mean + share * beside;
  return static_cast<float>(std::isfinite(fit) ? fit : mean);
}

Fit fit_of(const FitMoments& moments) {
  const double n = moments.count, mean = moments.luminance / n;
  const double variance = std::max(moments.luminance_sq / n - mean * mean, 0.0);
  const double relative = mean > 0 ? variance / (mean * mean) : 1;
  // Few sources say little of their variance: as if one more were off by the mean.
  const double ridge = kLeastRidge + (n * relative + 1) / (n - 1);
  if (!std::isfinite(ridge)) return {};  // one source alone, or none of a luminance
  std::array<double, kFeatures> mean_feature;
  for (std::size_t k = 0; k < kFeatures; ++k) mean_feature[k] = moments.sum[k] / n;
  std::array<double, kFeatureProducts> scatter = moments.product;
  for (std::size_t k = 0; k < kFeatures; ++k) {
    for (std::size_t l = 0; l <= k; ++l)
      scatter[product_at(k, l)] -= moments.sum[k] * mean_feature[l];
    scatter[product_at(k, k)] += ridge;
  }
  Fit fit{.slope = solve(scatter, mean_feature, ridge), .ridge = ridge};
  for (std::size_t k = 0; k < kFeatures; ++k) fit.at_mean += fit.slope[k] * mean_feature[k];
  return fit;
}

}  // namespace psf::filter
