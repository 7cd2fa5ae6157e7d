// The second pass against naive loops in long double, and what must hold of it.
#include "filter/pixels/second_pass.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "catch.h"
#include "core/parallel.h"
#include "filter/engine/instruction_sets.h"
#include "second_pass_setup.h"

namespace psf {
namespace {

using filter::PixelPlane;
using filter::PixelStatistics;
using tests::passed;
using tests::picture;

// [second], as it is written, for one pixel: the weighted mean and the constant of the fit of the
// light, and of `extra`.
class Naive {
 public:
  Naive(const PixelStatistics& s, const std::vector<float>& extra) : s_(s), extra_(extra) {
    long double paths = 0, logs = 0, count = 0;
    std::vector<long double> light;
    for (std::size_t k = 0; k < s.paths.size(); ++k) {
      if (s.paths[k] == 0) continue;
      if (luminance(k) > 0) light.push_back(luminance(k));
      paths += static_cast<long double>(s.paths[k]);
      ++count;
    }
    std::sort(light.begin(), light.end());
    const long double least = light[light.size() / 2] / 1000;
    for (std::size_t k = 0; k < s.paths.size(); ++k) {
      if (s.paths[k] > 0) logs += std::log(std::max(luminance(k), least));
    }
    const long double usual = std::exp(logs / count);
    noise_ = 0.016L * usual * usual / std::sqrt(paths / count);
  }

  // {mean, fit} of radiance 0, 1, 2, and of `extra`.
  [[nodiscard]] std::vector<std::pair<long double, long double>> at(int x, int y) const {
    constexpr std::size_t kOrder = 11;
    std::vector<std::vector<long double>> a(kOrder, std::vector<long double>(kOrder + 4));
    const std::size_t i = pixel(x, y);
    for (int dy = -6; dy <= 6; ++dy) {
      for (int dx = -6; dx <= 6; ++dx) {
        if (!inside(x + dx, y + dy) || s_.paths[pixel(x + dx, y + dy)] == 0) continue;
        const std::size_t j = pixel(x + dx, y + dy);
        const long double e = unlikeness(x, y, dx, dy);
        const long double w = std::pow(std::max(0.0L, 1 - std::max(0.0L, e) / 4), 4);
        const std::vector<long double> f = features(i, j);
        for (std::size_t r = 0; r < kOrder; ++r) {
          for (std::size_t c = 0; c < kOrder; ++c) a[r][c] += w * f[r] * f[c];
          for (std::size_t c = 0; c < 3; ++c) a[r][kOrder + c] += w * f[r] * radiance(c, j);
          a[r][kOrder + 3] += w * f[r] * static_cast<long double>(extra_[j]);
        }
      }
    }
    std::vector<std::pair<long double, long double>> results(4);
    for (std::size_t c = 0; c < 4; ++c) results[c].first = a[0][kOrder + c] / a[0][0];
    for (std::size_t r = 1; r < kOrder; ++r) a[r][r] += 1e-3L * a[0][0];
    solve(a, kOrder);
    for (std::size_t c = 0; c < 4; ++c) results[c].second = a[0][kOrder + c] / a[0][0];
    return results;
  }

 private:
  // Gauss and Jordan, with pivots from the diagonal, which is positive definite.
  static void solve(std::vector<std::vector<long double>>& a, std::size_t order) {
    for (std::size_t p = 0; p < order; ++p) {
      for (std::size_t r = 0; r < order; ++r) {
        if (r == p) continue;
        const long double factor = a[r][p] / a[p][p];
        for (std::size_t c = 0; c < a[r].size(); ++c) a[r][c] -= factor * a[p][c];
      }
    }
  }
  [[nodiscard]] bool inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < static_cast<int>(s_.width) && y < static_cast<int>(s_.height);
  }
  // Of the pixel, or of that of the picture's rim nearest to it.
  [[nodiscard]] std::size_t pixel(int x, int y) const {
    const int right = static_cast<int>(s_.width) - 1, bottom = static_cast<int>(s_.height) - 1;
    return static_cast<std::size_t>(std::clamp(y, 0, bottom)) * s_.width +
           static_cast<std::size_t>(std::clamp(x, 0, right));
  }
  [[nodiscard]] long double radiance(std::size_t c, std::size_t k) const {
    return s_.radiance[c * s_.paths.size() + k];
  }
  [[nodiscard]] long double luminance(std::size_t k) const {
    return 0.2126L * radiance(0, k) + 0.7152L * radiance(1, k) + 0.0722L * radiance(2, k);
  }
  [[nodiscard]] long double unlikeness(int x, int y, int dx, int dy) const {
    long double sum = 0;
    for (int py = -1; py <= 1; ++py) {
      for (int px = -1; px <= 1; ++px) {
        const std::size_t a = pixel(x + px, y + py), b = pixel(x + dx + px, y + dy + py);
        for (std::size_t c = 0; c < 3; ++c) {
          const bool first = s_.paths[a] > 0, second = s_.paths[b] > 0;
          const std::size_t at = c * s_.paths.size();
          const long double d = (first ? radiance(c, a) : 0) - (second ? radiance(c, b) : 0);
          const long double own = first ? static_cast<long double>(s_.variance[at + a]) : 0;
          const long double other = second ? static_cast<long double>(s_.variance[at + b]) : 0;
          const long double most = own + std::min(other, 10'000 * own);
          sum += (d * d - own - std::min(other, own)) / (noise_ + 0.64L * most) / 27;
        }
      }
    }
    return sum;
  }
  [[nodiscard]] long double distance(std::size_t a, std::size_t b) const {
    long double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = c * s_.paths.size();
      const long double d = static_cast<long double>(s_.position[at + a]) -
                            static_cast<long double>(s_.position[at + b]);
      sum += d * d;
    }
    return std::sqrt(sum);
  }
  [[nodiscard]] std::vector<long double> features(std::size_t i, std::size_t j) const {
    const std::size_t size = s_.paths.size();
    std::vector<long double> f = {1};
    for (const auto* of : {&s_.reflectance, &s_.normal}) {
      for (std::size_t c = 0; c < 3; ++c) {
        f.push_back(static_cast<long double>((*of)[c * size + j]) -
                    static_cast<long double>((*of)[c * size + i]));
      }
    }
    f.push_back(static_cast<long double>(s_.vertices[j]) -
                static_cast<long double>(s_.vertices[i]));
    long double nearest = 0;
    const int x = static_cast<int>(i % s_.width), y = static_cast<int>(i / s_.width);
    for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      if (!inside(x + dx, y + dy) || s_.vertices[pixel(x + dx, y + dy)] == 0) continue;
      const long double d = distance(i, pixel(x + dx, y + dy));
      if (d > 0 && (nearest == 0 || d < nearest)) nearest = d;
    }
    const bool both = s_.vertices[i] > 0 && s_.vertices[j] > 0 && nearest > 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const long double d = static_cast<long double>(s_.position[c * size + j]) -
                            static_cast<long double>(s_.position[c * size + i]);
      f.push_back(both ? std::clamp(d / (64 * nearest), -4.0L, 4.0L) : 0);
    }
    return f;
  }

  const PixelStatistics& s_;
  const std::vector<float>& extra_;
  long double noise_ = 0;
};

// With light below 0 in the last rows, black pixels, places far from those around them, places that
// are one, and pixels whose noise is up to a million times that of others.
PixelStatistics odd_picture(std::size_t width, std::size_t height, unsigned seed) {
  PixelStatistics s = picture(width, height, seed);
  const std::size_t size = width * height;
  for (std::size_t k = 0; k < size; ++k) {
    if (k % 11 == 4) s.position[k] += k % 2 == 0 ? 1000.0f : -1000.0f;
    for (std::size_t at = k; at < 3 * size; at += size) {
      if (k % 29 == 7) s.position[at] = s.position[at - 1];
      if (k / width >= height - height / 3) s.radiance[at] -= 4;
      if (k % 7 == 3) s.variance[at] *= static_cast<float>(k * k);
      if (k % 41 == 8) s.radiance[at] = s.variance[at] = 0;
    }
  }
  return s;
}

// Against Naive: the light, a part of its first colour, and the same numbers as no light.
void check_pass(const PixelStatistics& s) {
  const std::size_t size = s.paths.size();
  std::vector<float> part(size), light = s.radiance;
  for (std::size_t k = 0; k < size; ++k) part[k] = 0.25f * s.radiance[k];
  const std::vector<float> before = part;
  const Naive naive(s, before);
  std::vector<float> other = before;
  std::vector<PixelPlane> planes = {{part, 0}, {other, PixelPlane::kNoLight}};
  for (std::size_t c = 0; c < 3; ++c) {
    planes.push_back({std::span(light).subspan(c * size, size), c});
  }
  filter::second_pass(s, planes);
  double worst = 0, changed = 0;
  const auto compare = [&worst](long double expected, float value) {
    worst = std::max(worst, std::abs(static_cast<double>(expected) - double{value}));
  };
  for (std::size_t k = 0; k < size; ++k) {
    if (s.paths[k] == 0) {
      CHECK(light[k] == s.radiance[k]);
      continue;
    }
    const auto expected = naive.at(static_cast<int>(k % s.width), static_cast<int>(k / s.width));
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& [mean, fit] = expected[c];
      compare(fit >= 0 ? fit : std::min(mean, 0.0L), light[c * size + k]);
      changed = std::max(changed,
                         std::abs(double{light[c * size + k]} - double{s.radiance[c * size + k]}));
    }
    const auto& [mean, fit] = expected[0];
    const auto& [mean_of_part, fit_of_part] = expected[3];
    const long double step = fit >= 0 ? 1 : mean > 0 ? mean / (mean - fit) : 0;
    compare(mean_of_part + step * (fit_of_part - mean_of_part), part[k]);
    compare(fit_of_part, other[k]);
  }
  CHECK(worst < 2e-4);
  if (size > 100) CHECK(changed > 0.03);
}

TEST_CASE("The second pass is what naive loops give") {
  for (const auto& [width, height] :
       {std::pair(43u, 37u), {1u, 1u}, {5u, 40u}, {61u, 2u}, {30u, 16u}}) {
    INFO(width << " x " << height);
    check_pass(picture(width, height, 1));
    check_pass(odd_picture(width, height, 12));
  }
}

TEST_CASE("The second pass takes noise away, and keeps edges and gradients") {
  const PixelStatistics s = picture(60, 60, 2);
  const std::vector<float> values = passed(s);
  double before = 0, after = 0;
  for (std::size_t k = 0; k < s.paths.size(); ++k) {
    if (s.paths[k] == 0) continue;
    const bool right = static_cast<double>(k % 60) > 36;
    for (std::size_t c = 0; c < 3; ++c) {
      const double truth =
          (right ? 1.5 : 0.4) + 0.01 * static_cast<double>(k / 60) + 0.1 * static_cast<double>(c);
      before += std::pow(double{s.radiance[c * 3600 + k]} - truth, 2);
      after += std::pow(double{values[c * 3600 + k]} - truth, 2);
    }
  }
  CHECK(after < 0.2 * before);
}

TEST_CASE("What has no noise stays as it is") {
  PixelStatistics s = picture(40, 40, 3);
  std::fill(s.variance.begin(), s.variance.end(), 0.0f);
  s.paths.assign(s.paths.size(), std::uint64_t{1} << 40);  // a picture of 1e12 passes
  const std::vector<float> values = passed(s);
  for (std::size_t k = 0; k < values.size(); ++k) {
    CHECK(std::abs(values[k] - s.radiance[k]) < 2e-3f);
  }
}

TEST_CASE("The second pass of a picture a thousand times as bright is a thousand times as bright") {
  const std::vector<float> one = passed(picture(40, 40, 4)),
                           more = passed(picture(40, 40, 4, 1024));
  for (std::size_t k = 0; k < one.size(); ++k)
    CHECK(more[k] / 1024 == Approx(one[k]).epsilon(1e-5));
}

TEST_CASE("Parts of the light still add up after the second pass, and light is never below 0") {
  PixelStatistics s = picture(40, 40, 5);
  const std::size_t size = s.paths.size();
  // Dark, and darker still toward one side, so that fits fall below 0.
  std::mt19937 random(6);
  std::exponential_distribution<float> bright(1);
  for (std::size_t k = 0; k < 3 * size; ++k) {
    s.radiance[k] = k % 40 < 3 ? 0.0f : 0.1f * bright(random) * static_cast<float>(k % 40);
    s.variance[k] = s.radiance[k] * s.radiance[k] / 4;
  }
  std::vector<float> first(size), rest(size), whole(s.radiance.begin(), s.radiance.begin() + 1600);
  for (std::size_t k = 0; k < size; ++k) {
    first[k] = k % 3 == 0 ? s.radiance[k] : 0.25f * s.radiance[k];
    rest[k] = s.radiance[k] - first[k];
  }
  const std::vector<PixelPlane> planes = {{whole, 0}, {first, 0}, {rest, 0}};
  filter::second_pass(s, planes);
  std::size_t held = 0;
  for (std::size_t k = 0; k < size; ++k) {
    CHECK(whole[k] >= 0);
    CHECK(first[k] + rest[k] == Approx(whole[k]).margin(1e-5));
    if (s.paths[k] > 0 && whole[k] == 0) ++held;
  }
  CHECK(held > 0);
}

TEST_CASE("The second pass gives the same bytes for any instruction set and number of threads") {
  const PixelStatistics s = picture(75, 50, 11);
  const std::vector<float> best = passed(s);
  for (const std::string& set : filter::engine::instruction_sets()) {
    const filter::engine::InstructionSetLimit limit(set);
    INFO(set);
    CHECK(passed(s) == best);
  }
  for (const std::size_t threads : {1u, 3u}) {
    const core::ThreadLimit limit(threads);
    CHECK(passed(s) == best);
  }
}

}  // namespace
}  // namespace psf
