#include "metrics/flicker.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/error.h"

namespace psf::metrics {

Flicker::Flicker(std::size_t pixels, double epsilon)
    : epsilon_(epsilon), values_(3 * pixels), is_out_(pixels, 0) {
  if (epsilon > 0) return;
  throw Error(ErrorCode::usage, "`epsilon`: must be > 0, against division by zero");
}

void Flicker::add(std::span<const Rgb> picture, std::span<const Rgb> reference) {
  assert(picture.size() == is_out_.size() && reference.size() == is_out_.size());
  const auto changes = static_cast<double>(frames_);  // with this one
  for (std::size_t pixel = 0; pixel < is_out_.size(); ++pixel) {
    const Rgb &x = picture[pixel], &r = reference[pixel];
    if (!is_finite(x) || !is_finite(r)) is_out_[pixel] = 1;
    if (is_out_[pixel] != 0) continue;
    for (int channel = 0; channel < 3; ++channel) {
      const double truth = double{r[channel]};
      const double e = (double{x[channel]} - truth) / std::sqrt(truth * truth + epsilon_);
      Value& value = values_[3 * pixel + static_cast<std::size_t>(channel)];
      if (frames_ > 0) {
        const double off = (e - value.last) - value.mean;  // Welford 1962
        value.mean += off / changes;
        value.differences += off * ((e - value.last) - value.mean);
      }
      value.last = e;
      value.squares += e * e;
    }
  }
  ++frames_;
}

std::size_t Flicker::left_out() const {
  return static_cast<std::size_t>(std::count(is_out_.begin(), is_out_.end(), 1));
}

double Flicker::mean_of_smallest(std::vector<double> of_pixels, double trim) const {
  std::vector<double> kept;
  for (std::size_t pixel = 0; pixel < of_pixels.size(); ++pixel) {
    if (is_out_[pixel] == 0) kept.push_back(of_pixels[pixel]);
  }
  const auto trimmed =
      static_cast<std::size_t>(std::llround(trim * static_cast<double>(kept.size())));
  if (trimmed >= kept.size()) return std::numeric_limits<double>::quiet_NaN();
  if (trimmed > 0) std::sort(kept.begin(), kept.end());
  kept.resize(kept.size() - trimmed);
  return std::accumulate(kept.begin(), kept.end(), 0.0) / static_cast<double>(kept.size());
}

double Flicker::error(double trim) const {
  std::vector<double> all(is_out_.size(), 0);
  const double divisor = 3 * static_cast<double>(frames_);
  for (std::size_t k = 0; k < values_.size(); ++k) all[k / 3] += values_[k].squares / divisor;
  return mean_of_smallest(std::move(all), trim);
}

double Flicker::flicker(double trim) const {
  if (frames_ < 3) return std::numeric_limits<double>::quiet_NaN();
  return mean_of_smallest(map(), trim);
}

std::vector<double> Flicker::map() const {
  std::vector<double> all(is_out_.size(), 0);
  if (frames_ < 3) return all;
  const double divisor = 3 * static_cast<double>(frames_ - 2);
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (is_out_[k / 3] == 0) all[k / 3] += values_[k].differences / divisor;
  }
  return all;
}

}  // namespace psf::metrics
