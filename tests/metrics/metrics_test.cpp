// The metrics of single pixels, and means, against values worked out by hand.
#include "metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "metric_pictures.h"
#include "metrics/reference.h"

using psf::Rgb;
using namespace psf::metrics;
using psf::tests::noisy;
using psf::tests::painted;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Metrics measure(const std::vector<Rgb>& picture, const std::vector<Rgb>& reference,
                std::size_t width = 1) {
  return Reference(reference, width).measure(picture);
}

}  // namespace

TEST_CASE("a picture equals itself by every metric") {
  const std::vector<Rgb> picture = painted(40, 30);
  const Metrics metrics = measure(picture, picture, 40);
  for (const Metric metric :
       {Metric::rel_mse, Metric::mse, Metric::smape, Metric::mape, Metric::flip}) {
    INFO(name(metric));
    CHECK(metrics[metric] == 0);
  }
  CHECK(metrics[Metric::ssim] == 1);
  CHECK(std::isinf(metrics[Metric::psnr]));
  CHECK(metrics.pixels == 1200);
}

TEST_CASE("errors are means over pixels and colour channels, relative ones by the reference") {
  const std::vector<Rgb> picture = {Rgb(3, 0, 0), Rgb(0, 0, -1)};
  const std::vector<Rgb> reference = {Rgb(2, 0, 0), Rgb(0, 0, 0)};
  const Metrics metrics = measure(picture, reference);
  CHECK(metrics[Metric::mse] == Approx((1.0 + 1.0) / 6));
  CHECK(metrics[Metric::rel_mse] == Approx((1 / 4.01 + 1 / 0.01) / 6));
  CHECK(metrics[Metric::smape] == Approx((1 / 5.01 + 1 / 1.01) / 6));
  CHECK(metrics[Metric::mape] == Approx((1 / 2.01 + 1 / 0.01) / 6));
  CHECK(metrics[Metric::psnr] == Approx(10 * std::log10(3.0)));
  // Swapped, the 3 is what is divided by: relative error is not symmetric.
  const Metrics swapped = measure(reference, picture);
  CHECK(swapped[Metric::rel_mse] == Approx((1 / 9.01 + 1 / 1.01) / 6));
  CHECK(swapped[Metric::mape] == Approx((1 / 3.01 + 1 / 1.01) / 6));
  CHECK(swapped[Metric::smape] == metrics[Metric::smape]);

  // Opposite signs do not cancel below the line.
  CHECK(measure({Rgb(-1, 0, 0)}, {Rgb(1, 0, 0)})[Metric::smape] == Approx(2 / 2.01 / 3));

  MetricOptions options;
  options.epsilon = 1;
  CHECK(Reference(reference, 1, options).measure(picture)[Metric::rel_mse] ==
        Approx((1 / 5.0 + 1 / 1.0) / 6));
}

TEST_CASE("only what is asked for is measured, and it is the same as among all") {
  const std::vector<Rgb> reference = painted(30, 20), picture = noisy(reference, 0.3f);
  const Metrics all = measure(picture, reference, 30);
  const Metrics cheap = Reference(reference, 30, {}, kPixelMetrics).measure(picture);
  for (const Metric metric : kPixelMetrics) CHECK(cheap[metric] == all[metric]);
  CHECK(std::isnan(cheap[Metric::ssim]));
  CHECK(std::isnan(cheap[Metric::flip]));
  const Metric one[] = {Metric::psnr};
  const Metrics single = Reference(reference, 30, {}, one).measure(picture);
  CHECK(single[Metric::psnr] == all[Metric::psnr]);
  CHECK(std::isnan(single[Metric::rel_mse]));
}

TEST_CASE("a value that is not finite is left out, counted, and does not spread") {
  const std::size_t width = 30;
  const std::vector<Rgb> reference = painted(width, 20), picture = noisy(reference, 0.3f);
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    for (const bool in_reference : {false, true}) {
      std::vector<Rgb> bad_picture = picture, bad_reference = reference, like_reference = picture;
      (in_reference ? bad_reference : bad_picture)[157].y = bad;
      const Errors errors = Reference(bad_reference, width).errors(bad_picture);
      const Metrics metrics = errors.mean();
      CHECK(metrics.non_finite == 1);
      CHECK(metrics.pixels == 599);
      for (const Metric metric : kAllMetrics) CHECK(std::isfinite(metrics[metric]));
      CHECK(errors.non_finite()[157] != 0);

      // The mean of the others, whatever stands there.
      like_reference[157] = reference[157];
      const Errors others = Reference(reference, width).errors(like_reference);
      CHECK(metrics[Metric::mse] == Approx(others.mean()[Metric::mse] * 600 / 599));
      if (in_reference) continue;  // then its neighbours have another reference around them
      for (const Metric metric : {Metric::ssim, Metric::flip}) {
        for (std::size_t i = 0; i < 600; ++i) {
          if (i != 157) CHECK(errors.map(metric)[i] == others.map(metric)[i]);
        }
      }
    }
  }
  const std::vector<Rgb> nothing(600, Rgb(kNan));
  const Metrics none = measure(nothing, reference, width);
  CHECK(none.pixels == 0);
  for (const Metric metric : kAllMetrics) CHECK(std::isnan(none[metric]));
}

TEST_CASE("trimming leaves out the largest errors, of each metric its own") {
  // Errors of MSE: 0, 1, 4, 9 ... 99^2, in a mixed order.
  std::vector<Rgb> picture, reference;
  for (int i = 0; i < 100; ++i) {
    const auto error = static_cast<float>(i * 37 % 100);
    reference.emplace_back(i == 0 ? 0.0f : 1000.0f);  // the pixel of error 0 is the darkest
    picture.push_back(reference.back() + Rgb(error));
  }
  picture[0] = Rgb(0.5f);  // relative error of 25, by far the largest, and a small absolute one
  const Errors errors = Reference(reference, 10).errors(picture);
  Choice choice;
  choice.trim = 0.1;
  const Metrics metrics = errors.mean(choice);
  CHECK(metrics.trimmed == 10);
  CHECK(metrics.pixels == 90);
  double kept = 0.25, relative = 0;
  for (int error = 1; error < 90; ++error) kept += error * error;
  for (int error = 1; error <= 90; ++error) relative += error * error / (1e6 + 0.01);
  CHECK(metrics[Metric::mse] == Approx(kept / 90).epsilon(1e-9));
  CHECK(metrics[Metric::rel_mse] == Approx(relative / 90).epsilon(1e-9));
  CHECK(metrics[Metric::psnr] == Approx(-10 * std::log10(kept / 90)));

  // Where errors are equal, it makes no difference which are left out.
  const std::vector<Rgb> flat(100, Rgb(1)), above(100, Rgb(3));
  CHECK(Reference(flat, 10).errors(above).mean(choice)[Metric::mse] == 4);
}

TEST_CASE("a region is measured as the same pixels of the whole picture") {
  const std::size_t width = 40;
  const std::vector<Rgb> reference = painted(width, 30), picture = noisy(reference, 0.3f);
  const Errors errors = Reference(reference, width).errors(picture);
  const Region region = {11, 7, 9, 12};
  Choice choice;
  choice.region = region;
  const Metrics metrics = errors.mean(choice);
  CHECK(metrics.pixels == 108);
  for (const Metric metric :
       {Metric::rel_mse, Metric::mse, Metric::smape, Metric::mape, Metric::flip}) {
    double sum = 0;
    for (std::size_t y = 7; y < 19; ++y) {
      for (std::size_t x = 11; x < 20; ++x) sum += errors.map(metric)[y * width + x];
    }
    INFO(name(metric));
    CHECK(metrics[metric] == Approx(sum / 108));
  }
}

TEST_CASE("metrics have names, and options that make no sense are refused") {
  for (const Metric metric : kAllMetrics) CHECK(parse_metric(name(metric)) == metric);
  CHECK(parse_metric("relmse") == Metric::rel_mse);
  CHECK(parse_metric("FLIP") == Metric::flip);
  CHECK_THROWS_WITH(
      parse_metric("lpips"),
      "there is no metric \"lpips\", use one of relMSE, MSE, SMAPE, MAPE, PSNR, SSIM, FLIP");
  CHECK_THROWS_AS(parse_metric(""), psf::Error);
  const std::vector<Rgb> picture(4, Rgb(1));
  MetricOptions options;
  options.epsilon = 0;
  CHECK_THROWS_AS(Reference(picture, 2, options), psf::Error);
  options = {};
  options.pixels_per_degree = -1;
  CHECK_THROWS_AS(Reference(picture, 2, options), psf::Error);
  options = {};
  options.exposure = kNan;
  CHECK_THROWS_AS(Reference(picture, 2, options), psf::Error);
}

TEST_CASE("the same bits for any number of threads") {
  const std::vector<Rgb> reference = painted(131, 97), picture = noisy(reference, 0.2f);
  Choice choice;
  choice.trim = 0.01;
  std::vector<Metrics> found;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    const psf::core::ThreadLimit limit(threads);
    const Errors errors = Reference(reference, 131).errors(picture);
    found.push_back(errors.mean());
    found.push_back(errors.mean(choice));
  }
  for (std::size_t k = 2; k < found.size(); ++k) CHECK(found[k].values == found[k - 2].values);
}
