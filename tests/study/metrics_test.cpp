// Metrics against values worked out by hand.
#include "study/metrics.h"

#include <cmath>
#include <limits>
#include <vector>

#include "catch.h"

using psf::Rgb;
using psf::study::compare;

TEST_CASE("a picture equals itself") {
  const std::vector<Rgb> picture = {Rgb(0.1f, 0, 7), Rgb(1, 2, 3)};
  CHECK(compare(picture, picture).mse == 0);
  CHECK(compare(picture, picture).rel_mse == 0);
  CHECK(std::isinf(compare(picture, picture).psnr));
}

TEST_CASE("errors are means over pixels and colour channels, relative ones by the reference") {
  const std::vector<Rgb> picture = {Rgb(3, 0, 0), Rgb(0, 0, 1)};
  const std::vector<Rgb> reference = {Rgb(2, 0, 0), Rgb(0, 0, 0)};
  const auto metrics = compare(picture, reference);
  CHECK(metrics.mse == Approx((1.0 + 1.0) / 6));
  CHECK(metrics.rel_mse == Approx((1 / 4.01 + 1 / 0.01) / 6));
  CHECK(metrics.psnr == Approx(10 * std::log10(3.0)));
  // Swapped, the 3 is what is divided by: relative error is not symmetric.
  CHECK(compare(reference, picture).rel_mse == Approx((1 / 9.01 + 1 / 1.01) / 6));
}

TEST_CASE("a value that is not finite is never hidden") {
  const std::vector<Rgb> reference = {Rgb(1, 1, 1)};
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const std::vector<Rgb> picture = {Rgb(1, bad, 1)};
    CHECK_FALSE(std::isfinite(compare(picture, reference).rel_mse));
    CHECK_FALSE(std::isfinite(compare(reference, picture).rel_mse));
  }
}
