// [adaptive]'s test: up to which of several balls around a query contributions agree.
#pragma once

#include <cstdint>
#include <span>

namespace psf::filter {

// Of the luminances in a ball, and of their squares: sums in double.
struct Moments {
  std::uint32_t count = 0;
  double sum = 0, sum_sq = 0;
};

// Below so many contributions on either side there is no test, and the ball grows. Measured: with 8
// noise stops so many small balls that the arcade loses a quarter; with 128 shadows blur.
inline constexpr std::uint32_t kFewestTested = 64;

// Means that differ by less than this part of the larger agree, whatever their standard errors.
// That cannot be seen; and values that are alike to so many digits have variances of which the sums
// keep too few, so that the order of summation would decide.
inline constexpr double kAlike = 1.0 / 65536;

// Whether the mean of what `larger` has beyond `ball`, a part of it, is within `agree` standard
// errors of the mean of `ball` (Welch 1947: each side has a variance of its own, of n values over
// n - 1). One firefly, as bright as can be, has a standard error of its own size, so it makes no
// ball stop. What is not a number agrees.
[[nodiscard]] bool agrees(const Moments& ball, const Moments& larger, double agree);

// The last of `balls`, each a part of the next, up to which each agrees with the one before.
[[nodiscard]] std::size_t last_that_agrees(std::span<const Moments> balls, double agree);

}  // namespace psf::filter
