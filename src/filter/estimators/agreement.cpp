#include "filter/estimators/agreement.h"

#include <algorithm>
#include <cmath>

namespace psf::filter {
namespace {

struct Mean {
  double value, error_sq;  // squared standard error
};

Mean mean_of(double sum, double sum_sq, double count) {
  const double mean = sum / count;
  return {mean, std::max(0.0, sum_sq / count - mean * mean) / (count - 1)};
}

}  // namespace

bool agrees(const Moments& ball, const Moments& larger, double agree) {
  if (ball.count < kFewestTested || larger.count < ball.count + kFewestTested) return true;
  const Mean inside = mean_of(ball.sum, ball.sum_sq, ball.count);
  const Mean ring =
      mean_of(larger.sum - ball.sum, larger.sum_sq - ball.sum_sq, larger.count - ball.count);
  const double standard_error = std::sqrt(inside.error_sq + ring.error_sq);
  const double alike = kAlike * std::max(std::abs(inside.value), std::abs(ring.value));
  return !(std::abs(ring.value - inside.value) > std::max(agree * standard_error, alike));
}

std::size_t last_that_agrees(std::span<const Moments> balls, double agree) {
  std::size_t last = 0;
  while (last + 1 < balls.size() && agrees(balls[last], balls[last + 1], agree)) ++last;
  return last;
}

}  // namespace psf::filter
