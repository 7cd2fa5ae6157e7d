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

bool same_mean(const Moments& a, const Moments& b, double agree) {
  const Mean of_a = mean_of(a.sum, a.sum_sq, a.count), of_b = mean_of(b.sum, b.sum_sq, b.count);
  const double standard_error = std::sqrt(of_a.error_sq + of_b.error_sq);
  const double alike = kAlike * std::max(std::abs(of_a.value), std::abs(of_b.value));
  return !(std::abs(of_b.value - of_a.value) > std::max(agree * standard_error, alike));
}

bool agrees(const Moments& ball, const Moments& larger, double agree) {
  if (ball.count < kFewestTested || larger.count < ball.count + kFewestTested) return true;
  const Moments ring = {larger.count - ball.count, larger.sum - ball.sum,
                        larger.sum_sq - ball.sum_sq};
  return same_mean(ball, ring, agree);
}

std::size_t last_that_agrees(std::span<const Moments> balls, double agree) {
  std::size_t last = 0;
  while (last + 1 < balls.size() && agrees(balls[last], balls[last + 1], agree)) ++last;
  return last;
}

}  // namespace psf::filter
