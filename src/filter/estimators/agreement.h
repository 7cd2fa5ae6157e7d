// The test of [adaptive]: up to which of several balls around a query contributions agree.
#pragma once

#include <cstdint>
#include <span>

namespace psf::filter {

// The number of contributions in a ball, and the sums of their luminances and squared luminances.
struct Moments {
  std::uint32_t count = 0;
  double sum = 0, sum_sq = 0;
};

// Where either side has fewer contributions than this there is no test, and the ball grows.
// Measured: with 8, noise stops so many small balls that the arcade loses a quarter; with 128,
// shadows blur.
inline constexpr std::uint32_t kFewestTested = 64;

// Means that differ by at most this share of the larger agree, whatever their standard errors. Such
// a difference cannot be seen. And the sums of values that are alike to so many digits keep too few
// digits of their variance, so that the order of summation would decide.
inline constexpr double kAlike = 1.0 / 65536;

// Whether the means of two sets of contributions, which have none in common, are within `agree`
// standard errors of each other (Welch 1947: each side has its own sample variance). Returns true
// where the comparison meets NaN.
[[nodiscard]] bool same_mean(const Moments& a, const Moments& b, double agree);

// `ball` is a part of `larger`. Whether the mean of the rest of `larger` is within `agree` standard
// errors of the mean of `ball` (Welch 1947: each side has its own sample variance). A single
// firefly, however bright, has a standard error of its own size, so it makes no ball stop. Returns
// true where a comparison meets NaN.
[[nodiscard]] bool agrees(const Moments& ball, const Moments& larger, double agree);

// Each of `balls` is a part of the next. The number of the last ball up to which each ball agrees
// with the one before.
[[nodiscard]] std::size_t last_that_agrees(std::span<const Moments> balls, double agree);

}  // namespace psf::filter
