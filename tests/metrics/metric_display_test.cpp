// FLIP and SSIM: closed forms, the properties their papers state, and an oracle in numpy.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "../temp_folder.h"
#include "catch.h"
#include "metric_pictures.h"
#include "metrics/reference.h"
#include "metrics/ssim.h"

using psf::Rgb;
using namespace psf::metrics;
using psf::tests::noisy;
using psf::tests::painted;

namespace {

Metrics measure_display(const std::vector<Rgb>& picture, const std::vector<Rgb>& reference,
                        std::size_t width, const MetricOptions& options = {}) {
  return Reference(reference, width, options).measure(picture);
}

double of_constants(Metric metric, const Rgb& picture, const Rgb& reference) {
  const std::vector<Rgb> a(20 * 20, picture), b(20 * 20, reference);
  return measure_display(a, b, 20)[metric];
}

template <class T>
void write_raw(const std::string& path, const std::vector<T>& values) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(T)));
}

const std::string kPython = "/usr/bin/python3";  // Debian's, which has Debian's numpy

// 1 - SSIM or FLIP of every pixel.
std::vector<double> oracle(Metric metric, const std::vector<Rgb>& picture,
                           const std::vector<Rgb>& reference, std::size_t width,
                           const MetricOptions& options) {
  const psf::tests::TempFolder folder;
  write_raw(folder / "picture", picture);
  write_raw(folder / "reference", reference);
  const std::string line = kPython + " " PSF_SOURCE_DIR "/tests/metrics/metrics_oracle.py " +
                           (metric == Metric::ssim ? "ssim " : "flip ") + std::to_string(width) +
                           " " + std::to_string(options.exposure) + " " +
                           std::to_string(options.pixels_per_degree) + " " + (folder / "picture") +
                           " " + (folder / "reference") + " " + (folder / "out");
  REQUIRE(std::system(line.c_str()) == 0);
  std::vector<double> errors(picture.size());
  std::ifstream(folder / "out", std::ios::binary)
      .read(reinterpret_cast<char*>(errors.data()),
            static_cast<std::streamsize>(errors.size() * sizeof(double)));
  return errors;
}

}  // namespace

TEST_CASE("SSIM of two constants is the paper's luminance term of their sRGB values") {
  // sRGB 0.2 and 0.5 are 0.0331047666 and 0.2140411405 of linear light.
  const double c1 = 0.01 * 0.01;
  CHECK(of_constants(Metric::ssim, Rgb(0.0331047666f), Rgb(0.2140411405f)) ==
        Approx((2 * 0.2 * 0.5 + c1) / (0.2 * 0.2 + 0.5 * 0.5 + c1)).margin(1e-4));
  CHECK(of_constants(Metric::ssim, Rgb(0), Rgb(0.2140411405f)) ==
        Approx(c1 / (0.25 + c1)).margin(1e-4));
  // A channel that differs counts a third.
  CHECK(of_constants(Metric::ssim, Rgb(0, 1, 1), Rgb(0.2140411405f, 1, 1)) ==
        Approx((c1 / (0.25 + c1) + 2) / 3).margin(1e-4));
}

TEST_CASE(
    "FLIP is 1 between green and blue, the furthest there are, and known for black and white") {
  const float lamp = 1e6f;  // tone-mapped to exactly 1
  CHECK(of_constants(Metric::flip, Rgb(0, lamp, 0), Rgb(0, 0, lamp)) == Approx(1).epsilon(1e-4));
  // L* differs by 100, so the error is 100^0.7 = 25.119; the largest is 203.31^0.7 = 41.27 (from
  // L*, a*, b* of green 87.74, -86.18, 83.18 and blue 32.30, 79.19, -107.86), the knee at 0.4 of
  // that.
  const double largest = std::pow(203.31, 0.7), knee = 0.4 * largest;
  CHECK(of_constants(Metric::flip, Rgb(0), Rgb(lamp)) ==
        Approx(0.95 + 0.05 * (std::pow(100, 0.7) - knee) / (largest - knee)).epsilon(2e-4));
  // Mid-grey, L* 50, below the knee: 50^0.7 of it.
  CHECK(of_constants(Metric::flip, Rgb(0), Rgb(0.18418652f)) ==
        Approx(0.95 * std::pow(50, 0.7) / knee).epsilon(1e-3));
}

TEST_CASE("FLIP and SSIM are symmetric, in range, and grow with the noise") {
  const std::size_t width = 64;
  const std::vector<Rgb> reference = painted(width, 48);
  double flip = 0, ssim = 1;
  for (const float amplitude : {0.02f, 0.05f, 0.1f, 0.2f, 0.5f, 1.0f}) {
    const std::vector<Rgb> picture = noisy(reference, amplitude);
    const Errors errors = Reference(reference, width).errors(picture);
    for (const double error : errors.map(Metric::flip)) {
      CHECK(error >= 0);
      CHECK(error <= 1);
    }
    const Metrics there = errors.mean(), back = measure_display(reference, picture, width);
    CHECK(there[Metric::flip] == back[Metric::flip]);
    CHECK(there[Metric::ssim] == back[Metric::ssim]);
    CHECK(there[Metric::flip] > flip);
    CHECK(there[Metric::ssim] < ssim);
    flip = there[Metric::flip];
    ssim = there[Metric::ssim];
  }
}

TEST_CASE("an error is seen as far as the filters reach, and no further") {
  const std::size_t width = 64, x = 31, y = 20;
  std::vector<Rgb> reference(width * 48, Rgb(0.4f, 0.3f, 0.2f)), picture = reference;
  picture[y * width + x] = Rgb(0.1f, 0.6f, 0.5f);
  const Errors errors = Reference(reference, width).errors(picture);
  const auto reach = [&](Metric metric) {
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
      if (errors.map(metric)[i] <= 0) continue;
      const std::size_t dx = i % width > x ? i % width - x : x - i % width;
      const std::size_t dy = i / width > y ? i / width - y : y - i / width;
      farthest = std::max({farthest, dx, dy});
    }
    return farthest;
  };
  CHECK(reach(Metric::ssim) == kSsimRadius);
  CHECK(reach(Metric::flip) == 10);  // ceil(3 sqrt(0.04 / (2 pi^2)) 67.02)
  CHECK(reach(Metric::mse) == 0);
}

TEST_CASE("an exposure of e is the pictures times 2^e") {
  const std::vector<Rgb> reference = painted(40, 30), picture = noisy(reference, 0.3f);
  std::vector<Rgb> bright_reference = reference, bright_picture = picture;
  for (Rgb& color : bright_reference) color *= 4.0f;
  for (Rgb& color : bright_picture) color *= 4.0f;
  MetricOptions options;
  options.exposure = 2;
  const Metrics exposed = measure_display(picture, reference, 40, options);
  const Metrics bright = measure_display(bright_picture, bright_reference, 40);
  CHECK(exposed[Metric::flip] == bright[Metric::flip]);
  CHECK(exposed[Metric::ssim] == bright[Metric::ssim]);
  CHECK(exposed[Metric::flip] != measure_display(picture, reference, 40)[Metric::flip]);
  CHECK(exposed[Metric::mse] == measure_display(picture, reference, 40)[Metric::mse]);
}

TEST_CASE("SSIM counts the pixels whose window lies in the picture, or all where there are none") {
  const std::size_t width = 30, height = 20, r = kSsimRadius;
  const std::vector<Rgb> reference = painted(width, height), picture = noisy(reference, 0.3f);
  const Errors errors = Reference(reference, width).errors(picture);
  double sum = 0;
  for (std::size_t y = r; y < height - r; ++y) {
    for (std::size_t x = r; x < width - r; ++x) sum += errors.map(Metric::ssim)[y * width + x];
  }
  CHECK(errors.mean()[Metric::ssim] ==
        Approx(1 - sum / static_cast<double>((width - 2 * r) * (height - 2 * r))));
  Choice corner;
  corner.region = Region{0, 0, 2, 1};
  CHECK(errors.mean(corner)[Metric::ssim] ==
        Approx(1 - (errors.map(Metric::ssim)[0] + errors.map(Metric::ssim)[1]) / 2));
  const std::vector<Rgb> narrow(8, Rgb(0.2f)), other(8, Rgb(0.3f));
  CHECK(std::isfinite(measure_display(narrow, other, 4)[Metric::ssim]));
}

TEST_CASE("SSIM and FLIP are those of numpy with whole kernels, pixel by pixel") {
  if (std::system((kPython + " -c 'import numpy' 2>/dev/null").c_str()) != 0) {
    SKIP("Debian's python3 has no numpy");
  }
  struct Setting {
    float exposure;
    double pixels_per_degree;
    float amplitude;
  };
  for (const Setting& setting :
       {Setting{0, 67.0206, 0.3f}, Setting{-1.5f, 25, 1.0f}, Setting{2, 110, 0.05f}}) {
    // Neither side a multiple of a chunk, the smaller one narrower than the largest kernel.
    const std::size_t width = 53, height = 21;
    const std::vector<Rgb> reference = painted(width, height);
    const std::vector<Rgb> picture = noisy(reference, setting.amplitude);
    MetricOptions options;
    options.exposure = setting.exposure;
    options.pixels_per_degree = setting.pixels_per_degree;
    const Errors errors = Reference(reference, width, options).errors(picture);
    for (const Metric metric : {Metric::ssim, Metric::flip}) {
      const std::vector<double> expected = oracle(metric, picture, reference, width, options);
      double worst = 0;
      for (std::size_t i = 0; i < expected.size(); ++i) {
        REQUIRE(std::isfinite(expected[i]));
        worst = std::max(worst, std::abs(errors.map(metric)[i] - expected[i]));
      }
      INFO(name(metric) << ", " << setting.pixels_per_degree << " pixels per degree");
      CHECK(worst < 1e-4);
    }
  }
}
