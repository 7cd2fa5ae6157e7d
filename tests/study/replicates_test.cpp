// Bias and variance from replicates are those that the replicates were made with.
#include "study/replicates.h"

#include <cmath>
#include <limits>
#include <random>

#include "catch.h"

namespace psf {
namespace {

using Picture = std::vector<Rgb>;

constexpr std::size_t kWidth = 40, kReplicatePixels = 40 * 30;
constexpr double kEpsilon = 0.01;

Picture reference() {
  Picture picture(kReplicatePixels);
  for (std::size_t k = 0; k < kReplicatePixels; ++k) {
    const auto v = static_cast<float>(k % kWidth) / kWidth;
    picture[k] = Rgb(v, 1 - v, 2);
  }
  return picture;
}

// bias and noise as multiples of sqrt(r^2 + epsilon), so that the parts are their squares.
std::vector<Picture> replicates(std::size_t count, double bias, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Picture truth = reference();
  std::vector<Picture> pictures(count, truth);
  for (Picture& picture : pictures) {
    for (std::size_t k = 0; k < kReplicatePixels; ++k) {
      for (int c = 0; c < 3; ++c) {
        const double r = double{truth[k][c]};
        const double scale = std::sqrt(r * r + kEpsilon);
        picture[k][c] = static_cast<float>(r + scale * (bias + noise * normal(random)));
      }
    }
  }
  return pictures;
}

TEST_CASE("Bias and variance of replicates are told apart") {
  const auto parts = study::decompose(replicates(8, 0.1, 0.3, 1), reference(), kWidth, kEpsilon);
  CHECK(parts.bias_sq == Approx(0.01).margin(0.0025));
  CHECK(parts.variance == Approx(0.09).margin(0.004));
  CHECK(parts.error == Approx(parts.bias_sq + parts.variance).epsilon(1e-9));
}

TEST_CASE("The bias of unbiased replicates is 0 within its interval, however large their noise") {
  int held = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const auto parts = study::decompose(replicates(5, 0, 1, seed), reference(), kWidth, kEpsilon);
    const study::Interval& interval = parts.bias_sq_interval;
    held += interval.low <= 0 && 0 <= interval.high ? 1 : 0;
    CHECK(std::abs(parts.bias_sq) < 0.05);
  }
  CHECK(held >= 34);  // 38 of 40 are expected
}

TEST_CASE("Intervals of the variance hold it as often as they say") {
  int held = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const auto parts =
        study::decompose(replicates(6, 0.2, 0.5, 100 + seed), reference(), kWidth, kEpsilon);
    const study::Interval& interval = parts.variance_interval;
    held += interval.low <= 0.25 && 0.25 <= interval.high ? 1 : 0;
  }
  CHECK(held >= 34);
}

TEST_CASE("Too few replicates leave open what they do not say") {
  const auto one = study::decompose(replicates(1, 0.1, 0, 1), reference(), kWidth, kEpsilon);
  CHECK(one.error == Approx(0.01).epsilon(1e-4));
  CHECK(std::isnan(one.bias_sq));
  CHECK(std::isnan(one.variance));
  const auto two = study::decompose(replicates(2, 0.1, 0, 1), reference(), kWidth, kEpsilon);
  CHECK(two.bias_sq == Approx(0.01).epsilon(1e-4));
  CHECK(std::isnan(two.bias_sq_interval.low));
}

TEST_CASE("Only finite pixels of the region count") {
  auto pictures = replicates(3, 0.1, 0, 1);
  for (Picture& picture : pictures) picture[0] = Rgb(100, 100, 100);
  pictures[1][5 * kWidth + 5].x = std::numeric_limits<float>::quiet_NaN();
  const auto parts = study::decompose(pictures, reference(), kWidth, kEpsilon, {2, 3, 20, 10});
  CHECK(parts.bias_sq == Approx(0.01).epsilon(1e-4));
  CHECK(study::decompose(pictures, reference(), kWidth, kEpsilon).bias_sq > 1);
}

TEST_CASE("Student's t has the quantiles of its tables") {
  CHECK(study::student_t(1) == Approx(12.706));
  CHECK(study::student_t(5) == Approx(2.571));
  CHECK(study::student_t(15) == Approx(2.131).epsilon(1e-3));
  CHECK(study::student_t(30) == Approx(2.042).epsilon(1e-3));
  CHECK(study::student_t(1000) == Approx(1.962).epsilon(1e-3));
}

}  // namespace
}  // namespace psf
