// The declared quantisations keep what they promise.
#include "formats/layout/quantize.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "catch.h"

using namespace psf::formats;

namespace {

double degrees_between(const float* a, const float* b) {
  const double ab[3] = {double{a[0]} - b[0], double{a[1]} - b[1], double{a[2]} - b[2]};
  const double chord = std::sqrt(ab[0] * ab[0] + ab[1] * ab[1] + ab[2] * ab[2]);
  return 2 * std::asin(std::min(1.0, chord / 2)) * 180 / std::numbers::pi;
}

}  // namespace

TEST_CASE("octahedral directions are right to 0.004 degrees and unit") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const std::size_t count = 200000;
  std::vector<float> in(3 * count), out(3 * count);
  for (std::size_t k = 0; k < count; ++k) {
    double v[3] = {normal(random), normal(random), normal(random)};
    if (k % 10 == 0) v[k / 10 % 3] *= 1e-6;  // near the folds
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (std::size_t c = 0; c < 3; ++c) in[3 * k + c] = static_cast<float>(v[c] / length);
  }
  std::vector<std::uint16_t> codes(2 * count);
  encode_octahedral(in, codes);
  decode_octahedral(codes, out);
  double worst = 0, longest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    worst = std::max(worst, degrees_between(&in[3 * k], &out[3 * k]));
    longest = std::max(longest, std::abs(1 - std::sqrt(double{out[3 * k]} * out[3 * k] +
                                                       double{out[3 * k + 1]} * out[3 * k + 1] +
                                                       double{out[3 * k + 2]} * out[3 * k + 2])));
  }
  CAPTURE(worst);
  CHECK(worst < 0.004);
  CHECK(worst > 0.001);  // it is a quantisation
  CHECK(longest < 2e-7);
}

TEST_CASE(
    "octahedral axes and the zero vector are exact, and what is not finite comes back as NaN") {
  const std::vector<float> in = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0};
  std::vector<std::uint16_t> codes(14);
  std::vector<float> out(21);
  encode_octahedral(in, codes);
  decode_octahedral(codes, out);
  CHECK(out == in);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const std::vector<float>& bad :
       {std::vector<float>{nan, 0, 1}, {0, infinity, 0}, {0, 0, nan}}) {
    std::vector<std::uint16_t> code(2);
    std::vector<float> back(3);
    encode_octahedral(bad, code);
    decode_octahedral(code, back);
    CHECK(std::isnan(back[0]));
    CHECK(std::isnan(back[1]));
    CHECK(std::isnan(back[2]));
  }
}

TEST_CASE("half floats are IEEE binary16, rounded to nearest even") {
  std::vector<std::uint16_t> all(65536), back(65536);
  std::vector<float> values(65536);
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<std::uint16_t>(k);
  decode_half(all, values);
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const int exponent = static_cast<int>(k >> 10 & 31);
    const double mantissa = static_cast<double>(k & 1023);
    double expected =
        exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    if ((k & 0x8000) != 0) expected = -expected;
    const bool right = exponent < 31   ? double{values[k]} == expected
                       : mantissa == 0 ? std::isinf(values[k])
                                       : std::isnan(values[k]);
    wrong += right ? 0 : 1;
  }
  CHECK(wrong == 0);
  encode_half(values, back);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!std::isnan(values[k]) && back[k] != all[k]) ++wrong;
  }
  CHECK(wrong == 0);
  const std::vector<float> ties = {1 + 1.0f / 2048, 1 + 3.0f / 2048, 65519.0f, 65520.0f};
  std::vector<std::uint16_t> halves(4);
  encode_half(ties, halves);
  CHECK(halves == std::vector<std::uint16_t>{0x3C00, 0x3C02, 0x7BFF, 0x7C00});
}
