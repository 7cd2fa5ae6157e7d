#include "filter/estimators/agreement.h"

#include <algorithm>
#include <cmath>

namespace psf::filter {
namespace {

// Relative; means are rounded to floats, and equal contributions must agree.
constexpr double kRounding = 1e-5;

// Squared, of the mean.
double standard_error_sq(double mean, double mean_sq, double count) {
  return std::max(0.0, mean_sq - mean * mean) / (count - 1);
}

}  // namespace

bool agrees(const Moments& ball, const Moments& larger, double agree) {
  if (ball.count < kFewestTested || larger.count < ball.count + kFewestTested) return true;
  const double inside = ball.count, all = larger.count, beyond = all - inside;
  const double mean = (all * larger.mean - inside * ball.mean) / beyond;
  const double mean_sq = (all * larger.mean_sq - inside * ball.mean_sq) / beyond;
  const double error_sq =
      standard_error_sq(ball.mean, ball.mean_sq, inside) + standard_error_sq(mean, mean_sq, beyond);
  const double rounding = kRounding * (std::abs(mean) + std::abs(ball.mean));
  // A not-a-number, of luminances whose squares overflow, agrees.
  return !(std::abs(mean - ball.mean) > agree * std::sqrt(error_sq) + rounding);
}

std::size_t last_that_agrees(std::span<const Moments> balls, double agree) {
  std::size_t last = 0;
  while (last + 1 < balls.size() && agrees(balls[last], balls[last + 1], agree)) ++last;
  return last;
}

}  // namespace psf::filter
