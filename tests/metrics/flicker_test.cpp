// Flicker: against the equation in plain loops, and what it is of known errors.
#include "metrics/flicker.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "catch.h"
#include "core/error.h"

namespace psf {
namespace {

using metrics::Flicker;
using Pictures = std::vector<std::vector<Rgb>>;

Pictures random_pictures(std::size_t frames, std::size_t pixels, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Pictures all(frames);
  for (std::vector<Rgb>& picture : all) {
    for (std::size_t k = 0; k < pixels; ++k) {
      picture.emplace_back(unit(random), unit(random), unit(random));
    }
  }
  return all;
}

TEST_CASE("Error and flicker are what the equations say") {
  constexpr std::size_t kFrames = 5, kPixels = 7;
  const Pictures x = random_pictures(kFrames, kPixels, 1), r = random_pictures(kFrames, kPixels, 2);
  Flicker measured(kPixels, 0.01);
  for (std::size_t f = 0; f < kFrames; ++f) measured.add(x[f], r[f]);
  double error = 0, flicker = 0;
  for (std::size_t p = 0; p < kPixels; ++p) {
    for (int c = 0; c < 3; ++c) {
      std::vector<double> e;
      for (std::size_t f = 0; f < kFrames; ++f) {
        const double truth = double{r[f][p][c]};
        e.push_back((double{x[f][p][c]} - truth) / std::sqrt(truth * truth + 0.01));
        error += e.back() * e.back() / (3 * kPixels * kFrames);
      }
      double mean = 0, sum = 0;
      for (std::size_t f = 0; f + 1 < kFrames; ++f) mean += (e[f + 1] - e[f]) / (kFrames - 1);
      for (std::size_t f = 0; f + 1 < kFrames; ++f) sum += std::pow(e[f + 1] - e[f] - mean, 2);
      flicker += sum / (kFrames - 2) / (3 * kPixels);
    }
  }
  CHECK(std::abs(measured.error() - error) < 1e-12);
  CHECK(std::abs(measured.flicker() - flicker) < 1e-12);
  double of_map = 0;
  for (const double value : measured.map()) of_map += value / kPixels;
  CHECK(std::abs(of_map - flicker) < 1e-12);
}

TEST_CASE("An error that stays does not flicker, one that is new in each frame flickers twice") {
  constexpr std::size_t kFrames = 200, kPixels = 100;
  const std::vector<Rgb> truth(kPixels, Rgb(1, 1, 1)), off(kPixels, Rgb(1.5f, 1.5f, 1.5f));
  const Pictures noisy = random_pictures(kFrames, kPixels, 3);
  Flicker stays(kPixels, 1e-9), fresh(kPixels, 1e-9);
  for (std::size_t f = 0; f < kFrames; ++f) {
    stays.add(off, truth);
    fresh.add(noisy[f], truth);
  }
  CHECK(std::abs(stays.error() - 0.25) < 1e-6);
  CHECK(stays.flicker() == 0);
  CHECK(std::abs(fresh.flicker() - 2.0 / 12) < 0.01);  // the variance of [0, 1] is 1/12
}

TEST_CASE("A pixel that is not finite is out of all frames, and two frames have no flicker") {
  const std::vector<Rgb> truth(2, Rgb(1, 1, 1));
  std::vector<Rgb> picture(2, Rgb(2, 2, 2));
  Flicker measured(2, 1e-9);
  measured.add(picture, truth);
  picture[1].y = std::numeric_limits<float>::quiet_NaN();
  measured.add(picture, truth);
  CHECK(std::isnan(measured.flicker()));
  picture[1].y = 100;
  measured.add(picture, truth);
  CHECK(measured.left_out() == 1);
  CHECK(measured.flicker() == 0);
  CHECK(std::abs(measured.error() - 1) < 1e-6);
  CHECK_THROWS_AS(Flicker(1, 0), Error);
}

}  // namespace
}  // namespace psf
