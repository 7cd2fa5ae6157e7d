// On an analytic field the bias and the variance of the mean over blocks fall as the theory says.
#include <cmath>
#include <random>

#include "catch.h"
#include "filter/estimate.h"
#include "filter/radius.h"
#include "record_set.h"

namespace psf {
namespace {

constexpr std::uint32_t kSquareSide =
    64;  // pixels; one jittered path each a pass, on the unit square
const std::vector<filter::CameraView> kSquareCamera = {
    {kSquareSide, kSquareSide, 1.0 / kSquareSide}};

// Squared bias and variance of the pixels away from the border, after 1, 2, 3 ... passes.
struct Errors {
  std::vector<double> bias_sq, variance;
};

Errors measure(double r0, double delta, std::uint32_t passes) {
  filter::Parameters parameters;
  parameters.radius = {r0, filter::RadiusBasis::world, delta, {}};
  parameters.weights = filter::WeightTerms::none();
  const std::size_t count = kSquareSide * kSquareSide;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  std::normal_distribution<float> noise(0, 1);
  tests::RecordSet set(count);
  // Both are linear, so one run each: red is x^2 + y^2 without noise, green is noise around 0.
  std::vector<double> bias(count), noise_sum(count);
  Errors errors;
  for (std::uint32_t pass = 1; pass <= passes; ++pass) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const float x = (static_cast<float>(i % kSquareSide) + unit(random)) / kSquareSide;
      const float y = (static_cast<float>(i / kSquareSide) + unit(random)) / kSquareSide;
      set.position[i] = Vec3(x, y, 0);
      set.contribution[i] = Rgb(x * x + y * y, noise(random), 0);
    }
    const filter::Block block{0, double(pass), 1, kSquareCamera};
    std::vector<float> radius;
    filter::radii(parameters.radius, set.view(), block, radius);
    const filter::Estimates average = filter::estimate(set.view(), radius, block, parameters);
    double bias_mean = 0, square = 0, inside = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      bias[i] += double{average.c_bar[i].x} - double{set.contribution[i].x};
      noise_sum[i] += double{average.c_bar[i].y};
      const std::uint32_t x = i % kSquareSide, y = i / kSquareSide, rim = 12;
      if (x < rim || y < rim || x >= kSquareSide - rim || y >= kSquareSide - rim) continue;
      bias_mean += bias[i] / pass;
      square += noise_sum[i] * noise_sum[i] / pass / pass;
      ++inside;
    }
    errors.bias_sq.push_back(bias_mean * bias_mean / inside / inside);
    errors.variance.push_back(square / inside);
  }
  return errors;
}

double slope(const std::vector<double>& values, std::size_t from, std::size_t to) {
  return std::log(values[to - 1] / values[from - 1]) /
         std::log(static_cast<double>(to) / static_cast<double>(from));
}

TEST_CASE("Bias and variance fall as the theory says") {
  for (const double delta : {0.0, 0.3, 0.6}) {
    const Errors errors = measure(0.15, delta, 64);
    INFO("delta " << delta);
    // The bias of a pixel is the mean over blocks of what falls like k^-delta; its square nears
    // n^(-2 delta).
    std::vector<double> expected;
    double sum = 0;
    for (std::uint32_t n = 1; n <= 64; ++n) {
      sum += std::pow(n, -delta);
      expected.push_back(sum * sum / n / n);
    }
    CHECK(slope(errors.bias_sq, 16, 64) == Approx(slope(expected, 16, 64)).margin(0.06));
    CHECK(slope(errors.bias_sq, 16, 64) == Approx(-2 * delta).margin(0.2));
    CHECK(slope(errors.variance, 4, 64) == Approx(-(1 - delta)).margin(0.25));
    // The mean of x^2 + y^2 over a disk of radius r is r^2 / 2 above its centre.
    if (delta == 0) CHECK(std::sqrt(errors.bias_sq[63]) == Approx(0.15 * 0.15 / 2).epsilon(0.03));
  }
}

}  // namespace
}  // namespace psf
