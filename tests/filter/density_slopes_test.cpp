// The bias and the variance of [density], progressive photon mapping, fall as its alpha says.
#include <cmath>
#include <numbers>
#include <random>

#include "catch.h"
#include "photon_set.h"

namespace psf {
namespace {

// Running means over the passes 1, 2, 3 ... of one block each, at fixed places of the unit square.
struct PhotonErrors {
  std::vector<double> bias_sq, variance;
};

PhotonErrors measure_photons(double r0, double delta, std::uint32_t passes, std::uint32_t seed) {
  constexpr std::uint32_t kPlaces = 32, kCells = 128;
  constexpr float kSide = 1.4f;  // of the square of the photons, around the unit square
  tests::RecordSet set(kPlaces * kPlaces);
  for (std::uint32_t i = 0; i < set.size(); ++i) {
    set.position[i] = Vec3((static_cast<float>(i % kPlaces) + 0.5f) / kPlaces, 0,
                           (static_cast<float>(i / kPlaces) + 0.5f) / kPlaces);
    set.reflectance[i] = Rgb(std::numbers::pi_v<float>);  // the BSDF is 1
  }
  auto parameters = tests::density_parameters(filter::WeightTerms::none(), r0);
  parameters.radius.delta = delta;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  tests::PhotonSet photons(kCells * kCells);
  std::vector<double> light(set.size()), noise(set.size());
  PhotonErrors errors;
  for (std::uint32_t pass = 1; pass <= passes; ++pass) {
    for (std::uint32_t p = 0; p < photons.size(); ++p) {
      const float x = kSide * (static_cast<float>(p % kCells) + unit(random)) / kCells - 0.2f;
      const float z = kSide * (static_cast<float>(p / kCells) + unit(random)) / kCells - 0.2f;
      // Red: a flux density of x^2 + z^2, nearly without noise. Green: noise around 0.
      photons.position[p] = Vec3(x, 0, z);
      photons.power[p] = Rgb((x * x + z * z) * kSide * kSide / (kCells * kCells),
                             unit(random) < 0.5f ? -1.0f : 1.0f, 0);
    }
    const filter::Estimates result = tests::run_density(set, photons, parameters, pass);
    double bias = 0, square = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      const Vec3& x = set.position[i];
      light[i] += double{result.c_bar[i].x} - double{x.x * x.x + x.z * x.z};
      noise[i] += double{result.c_bar[i].y};
      bias += light[i] / pass / static_cast<double>(set.size());
      square += noise[i] * noise[i] / pass / pass / static_cast<double>(set.size());
    }
    errors.bias_sq.push_back(bias * bias);
    errors.variance.push_back(square);
  }
  return errors;
}

double slope_between(const std::vector<double>& values, std::size_t from, std::size_t to) {
  return std::log(values[to - 1] / values[from - 1]) /
         std::log(static_cast<double>(to) / static_cast<double>(from));
}

TEST_CASE("Bias and variance of progressive photon mapping fall as alpha = 1 - delta says") {
  constexpr std::uint32_t kMostPasses = 64;
  for (const double delta : {0.0, 1.0 / 3, 0.6}) {
    INFO("delta " << delta);
    std::vector<double> bias, variance;
    double radii = 0, inverse = 0;
    for (std::uint32_t n = 1; n <= kMostPasses; ++n) {
      radii += std::pow(n, -delta);   // the bias of a pass goes with r^2
      inverse += std::pow(n, delta);  // its variance with 1 / r^2
      bias.push_back(radii * radii / n / n);
      variance.push_back(inverse / n / n);
    }
    const PhotonErrors wide = measure_photons(0.15, delta, kMostPasses, 1);
    CHECK(std::sqrt(wide.bias_sq[0]) == Approx(0.15 * 0.15 / 2).epsilon(0.03));
    CHECK(slope_between(wide.bias_sq, 16, 64) == Approx(slope_between(bias, 16, 64)).margin(0.06));
    CHECK(slope_between(wide.bias_sq, 16, 64) == Approx(-2 * delta).margin(0.25));
    std::vector<double> noise(kMostPasses);
    for (const std::uint32_t seed : {2u, 3u, 4u, 5u}) {
      const PhotonErrors narrow = measure_photons(0.03, delta, kMostPasses, seed);
      for (std::size_t k = 0; k < noise.size(); ++k) noise[k] += narrow.variance[k];
    }
    CHECK(slope_between(noise, 2, 64) == Approx(slope_between(variance, 2, 64)).margin(0.06));
    CHECK(slope_between(noise, 2, 64) == Approx(-(1 - delta)).margin(0.12));
  }
}

}  // namespace
}  // namespace psf
