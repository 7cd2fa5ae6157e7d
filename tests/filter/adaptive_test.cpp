// [adaptive]: balls stop where contributions no longer agree, and only there.
#include "filter/estimators/adaptive.h"

#include <cmath>
#include <random>

#include "catch.h"
#include "estimator_case.h"
#include "filter/estimators/agreement.h"

namespace psf {
namespace {

using filter::Estimator;
using filter::Moments;
using tests::EstimatorRun;
using tests::RecordSet;

Moments moments_of(const std::vector<double>& values, std::size_t count) {
  Moments m{static_cast<std::uint32_t>(count), 0, 0};
  for (std::size_t k = 0; k < count; ++k) {
    m.sum += values[k];
    m.sum_sq += values[k] * values[k];
  }
  return m;
}
Moments with_means(std::uint32_t count, double mean, double mean_sq) {
  return {count, count * mean, count * mean_sq};
}

// The share of cases in which a ball of `inside` and what is around it, `beyond`, do not agree.
template <typename Draw>
double share_stopped(std::size_t inside, std::size_t beyond, double agree, Draw draw) {
  std::mt19937 random(1);
  std::size_t stopped = 0;
  constexpr std::size_t kCases = 20000;
  for (std::size_t t = 0; t < kCases; ++t) {
    std::vector<double> values;
    for (std::size_t k = 0; k < inside + beyond; ++k) values.push_back(draw(random, k >= inside));
    const bool agreed =
        filter::agrees(moments_of(values, inside), moments_of(values, inside + beyond), agree);
    stopped += agreed ? 0u : 1u;
  }
  return double(stopped) / kCases;
}

TEST_CASE("Of normal noise as many balls stop as the normal distribution says") {
  const auto noise = [](std::mt19937& random, bool) {
    return std::normal_distribution<double>(3, 1)(random);
  };
  // Two-sided: 4.55% beyond 2 standard errors, 0.27% beyond 3; a little more of few.
  CHECK(share_stopped(200, 200, 2, noise) == Approx(0.0455).margin(0.006));
  CHECK(share_stopped(200, 200, 3, noise) == Approx(0.0027).margin(0.0015));
  CHECK(share_stopped(64, 200, 1.5, noise) == Approx(0.1336).margin(0.012));
}

TEST_CASE("A step of three times the noise of the means is found, a small one is not") {
  for (const double step : {0.1, 1.0}) {
    const auto field = [step](std::mt19937& random, bool beyond) {
      return std::normal_distribution<double>(beyond ? 3 + step : 3, 1)(random);
    };
    const double share = share_stopped(100, 100, 3, field);
    INFO("step " << step);
    if (step == 1) CHECK(share > 0.99);
    if (step == 0.1) CHECK(share < 0.03);
  }
}

TEST_CASE("A firefly makes no ball stop, wherever it lies and however bright it is") {
  for (const bool outside : {false, true}) {
    for (const double bright : {1e2, 1e4, 1e8}) {
      std::mt19937 random(2);
      std::uniform_real_distribution<double> unit(0.5, 1.5);
      std::size_t stopped = 0;
      for (int t = 0; t < 2000; ++t) {
        std::vector<double> values(192);
        for (double& v : values) v = unit(random);
        values[outside ? 140 : 10] = bright;
        stopped += filter::agrees(moments_of(values, 64), moments_of(values, 192), 1.5) ? 0u : 1u;
      }
      CHECK(stopped == 0);
    }
  }
}

TEST_CASE("Paths with a long tail stop balls more often than normal noise, within bounds") {
  const auto noise = [](std::mt19937& random, bool) {
    return std::lognormal_distribution<double>(0, 1.5)(random);
  };
  // Normal noise: 0.27% and 13.4%.
  CHECK(share_stopped(100, 100, 3, noise) < 0.005);
  CHECK(share_stopped(100, 100, 1.5, noise) < 0.18);
  // A small ball without its share of the tail, beside a ring that has it, is what fails.
  CHECK(share_stopped(64, 640, 3, noise) > 0.01);
  CHECK(share_stopped(64, 640, 3, noise) < 0.1);
}

TEST_CASE("Few contributions and equal ones always agree; so does what is no number") {
  CHECK(filter::agrees(with_means(63, 1, 1), with_means(900, 9, 81.5), 0.1));
  CHECK(filter::agrees(with_means(64, 1, 1), with_means(127, 9, 81), 0.1));
  const double tenth = double{0.1f};
  CHECK(filter::agrees(with_means(64, tenth, tenth * tenth), with_means(500, tenth, tenth * tenth),
                       0.1));
  CHECK_FALSE(filter::agrees(with_means(64, 1, 1), with_means(500, 2, 4.1), 3));
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(filter::agrees(with_means(64, 1, infinity), with_means(500, 2, infinity), 3));
  CHECK(filter::agrees(with_means(64, infinity, 1), with_means(500, infinity, 1), 3));
}

TEST_CASE("Means that are alike to 2^-16 agree, whatever their standard errors") {
  for (const double part : {0.99, 1.01}) {
    std::vector<double> values(64, 1024);
    values.resize(128, 1024 + part * 1024 * filter::kAlike);
    CHECK(filter::agrees(moments_of(values, 64), moments_of(values, 128), 1) == (part < 1));
  }
}

TEST_CASE("Below the threshold a ball grows, above it stops, however near") {
  // 64 values each, of spread 1 around 3 and around 3 + step.
  const double standard_error = std::sqrt(2.0 / 63);
  for (const double agree : {0.5, 1.0, 3.0}) {
    for (const double off : {1e-3, 1e-6, 1e-9}) {
      for (const bool beyond : {false, true}) {
        const double step = agree * standard_error * (beyond ? 1 + off : 1 - off);
        std::vector<double> values;
        for (std::size_t k = 0; k < 128; ++k)
          values.push_back((k < 64 ? 3 : 3 + step) + (k % 2 == 0 ? 1 : -1));
        INFO("agree " << agree << ", off " << off);
        CHECK(filter::agrees(moments_of(values, 64), moments_of(values, 128), agree) != beyond);
      }
    }
  }
}

// A square of noise around 1 on the left and 3 on the right.
RecordSet step_of_noise(std::size_t count, float right) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  RecordSet set(count);
  for (std::size_t i = 0; i < count; ++i) {
    set.position[i] = Vec3(2 * unit(random), 0, unit(random));
    const float c = (set.position[i].x < 1 ? 1 : right) * 2 * unit(random);
    set.contribution[i] = Rgb(c, c, c);
  }
  return set;
}

TEST_CASE("A ball keeps away from a step and is whole elsewhere") {
  const RecordSet set = step_of_noise(60000, 4);
  EstimatorRun run(Estimator::adaptive, 0.2);
  run.parameters.agree = 3;
  const filter::Estimates adaptive = run(set);
  const filter::Estimates average = EstimatorRun(Estimator::average, 0.2)(set);
  double error = 0, error_of_average = 0;
  std::size_t whole = 0, far = 0, near = 0, small = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const double x = double{set.position[i].x}, truth = x < 1 ? 1 : 4;
    error += std::pow(double{adaptive.c_bar[i].x} - truth, 2);
    error_of_average += std::pow(double{average.c_bar[i].x} - truth, 2);
    const double gap = std::abs(x - 1);
    if (gap > 0.21) {
      ++far;
      whole += adaptive.radius[i] == 0.2f ? 1u : 0u;
      if (adaptive.radius[i] == 0.2f) REQUIRE(adaptive.neighbors[i] == average.neighbors[i]);
    }
    if (gap < 0.1 && gap > 0.06) {
      ++near;
      small += adaptive.radius[i] < 0.2f ? 1u : 0u;
    }
  }
  CHECK(double(whole) > 0.9 * double(far));
  CHECK(double(small) > 0.99 * double(near));
  CHECK(error < error_of_average / 2);
}

TEST_CASE("Where nothing tells records apart every radius is the largest, and c_bar is average's") {
  const RecordSet set = step_of_noise(3000, 1);
  EstimatorRun run(Estimator::adaptive, 0.2);
  run.parameters.agree = 1e9;
  const filter::Estimates adaptive = run(set);
  CHECK(adaptive.radius == std::vector<float>(set.size(), 0.2f));
  CHECK(tests::same_bytes(adaptive.c_bar, EstimatorRun(Estimator::average, 0.2)(set).c_bar));
}

// [adaptive] a second time, from the page alone: for every record its radius, and how many tests
// came within a thousandth above the threshold.
struct Chosen {
  std::vector<float> radius;
  std::size_t near = 0;
};
Chosen by_the_page(const RecordSet& set, float r, double agree) {
  Chosen chosen;
  constexpr int kRadii = 8;
  for (std::size_t i = 0; i < set.size(); ++i) {
    float radius[kRadii];
    long double count[kRadii] = {}, sum[kRadii] = {}, sum_sq[kRadii] = {};
    for (int k = 0; k < kRadii; ++k)
      radius[k] = static_cast<float>(double{r} * std::pow(2.0, -0.5 * (kRadii - 1 - k)));
    for (std::size_t j = 0; j < set.size(); ++j) {
      const float dx = set.position[i].x - set.position[j].x,
                  dy = set.position[i].y - set.position[j].y,
                  dz = set.position[i].z - set.position[j].z;
      const float d_sq = dx * dx + dy * dy + dz * dz;
      const Rgb& c = set.contribution[j];
      const long double y = 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
      for (int k = kRadii - 1; k >= 0 && (i == j || d_sq < radius[k] * radius[k]); --k) {
        count[k] += 1;
        sum[k] += y;
        sum_sq[k] += y * y;
      }
    }
    int k = 0;
    for (; k + 1 < kRadii; ++k) {
      const long double inside = count[k], beyond = count[k + 1] - inside;
      if (inside < 64 || beyond < 64) continue;
      const long double mean = sum[k] / inside, ring = (sum[k + 1] - sum[k]) / beyond;
      const long double spread = sum_sq[k] / inside - mean * mean,
                        ring_spread = (sum_sq[k + 1] - sum_sq[k]) / beyond - ring * ring;
      const long double t =
          std::abs(ring - mean) / std::sqrt(spread / (inside - 1) + ring_spread / (beyond - 1));
      chosen.near += t > agree && t < 1.001 * agree ? 1u : 0u;
      if (t > agree) break;
    }
    chosen.radius.push_back(radius[k]);
  }
  return chosen;
}

TEST_CASE("Radii are those of the page, to the last record, by every search") {
  RecordSet set = step_of_noise(9000, 1.1f);
  std::mt19937 random(8);
  std::exponential_distribution<float> tail;
  for (Rgb& c : set.contribution) c = Rgb(c.x, tail(random), 0.5f * c.x);
  EstimatorRun run(Estimator::adaptive, 0.3);
  run.parameters.agree = 1;
  const Chosen right = by_the_page(set, 0.3f, 1);
  CHECK(right.near > 5);
  CHECK(run(set).radius == right.radius);
  run.parameters.engine = filter::EngineKind::plain;
  CHECK(run(set).radius == right.radius);
}

// How many records another kind of search gives another radius.
std::size_t different(const RecordSet& set, EstimatorRun run, const std::vector<float>& radius,
                      filter::EngineKind kind) {
  run.parameters.engine = kind;
  const std::vector<float> found = run(set).radius;
  std::size_t count = 0;
  for (std::size_t i = 0; i < set.size(); ++i) count += found[i] != radius[i] ? 1u : 0u;
  return count;
}

TEST_CASE("Contributions that are nearly equal give the same radii by every search") {
  const RecordSet noise = step_of_noise(6000, 1);
  for (const double level : {1.0, 3.3}) {
    for (const int bits : {8, 12, 15, 16, 17, 18, 20, 22, 23}) {
      RecordSet set = noise;
      for (Rgb& c : set.contribution) {
        c = Rgb(static_cast<float>(level * (1 + std::ldexp(0.5 * double{c.x}, -bits))));
      }
      EstimatorRun run(Estimator::adaptive, 0.3);
      run.parameters.agree = 1;
      const std::vector<float> radius = run(set).radius;
      INFO(level << " (1 + [0, 2^-" << bits << "])");
      CHECK(different(set, run, radius, filter::EngineKind::plain) == 0);
      CHECK(different(set, run, radius, filter::EngineKind::brute) == 0);
    }
  }
}

TEST_CASE("A nearly even half beside a noisy one gives the same radii by every search") {
  for (const int bits : {12, 16, 18, 22}) {
    RecordSet set = step_of_noise(6000, 4);
    for (std::size_t i = 0; i < set.size(); ++i) {
      Rgb& c = set.contribution[i];
      if (set.position[i].x < 1) c = Rgb(static_cast<float>(7 + std::ldexp(double{c.x}, -bits)));
    }
    EstimatorRun run(Estimator::adaptive, 0.3);
    run.parameters.agree = 1;
    const std::vector<float> radius = run(set).radius;
    INFO("2^-" << bits);
    CHECK(different(set, run, radius, filter::EngineKind::plain) == 0);
    CHECK(different(set, run, radius, filter::EngineKind::brute) == 0);
  }
}

TEST_CASE("Contributions in any unit give the same radii by every search") {
  const RecordSet set = step_of_noise(4096, 1.5f);
  EstimatorRun run(Estimator::adaptive, 0.3);
  run.parameters.agree = 1;
  const std::vector<float> radius = run(set).radius;
  for (const int unit : {-100, -90, -75, -63, -40, 20, 60, 120}) {
    RecordSet other = set;
    for (Rgb& c : other.contribution) c = Rgb(std::ldexp(c.x, unit));
    INFO("2^" << unit);
    CHECK(different(other, run, radius, filter::EngineKind::flann) == 0);
    CHECK(different(other, run, radius, filter::EngineKind::plain) == 0);
    CHECK(different(other, run, radius, filter::EngineKind::brute) == 0);
  }
}

TEST_CASE("Contributions of which floats cannot hold all squares give the same radii") {
  RecordSet set = step_of_noise(4096, 1.5f);
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.position[i].x < 1) set.contribution[i] = Rgb(std::ldexp(set.contribution[i].x, -110));
  }
  EstimatorRun run(Estimator::adaptive, 0.3);
  run.parameters.agree = 1;
  CHECK(different(set, run, run(set).radius, filter::EngineKind::brute) == 0);
}

TEST_CASE("Every engine chooses the same radii") {
  RecordSet set = step_of_noise(20000, 4);
  // Sums of whole numbers are exact in any order.
  for (Rgb& c : set.contribution) c = Rgb(0, std::floor(16 * c.x), 0);
  for (std::size_t i = 0; i < set.size(); i += 3) set.flags[i] = filter::kHasVertex;
  EstimatorRun run(Estimator::adaptive, 0.2);
  run.parameters.agree = 2;
  const filter::Estimates fast = run(set);
  run.parameters.engine = filter::EngineKind::plain;
  const filter::Estimates plain = run(set);
  CHECK(fast.neighbors == plain.neighbors);
  CHECK(fast.radius == plain.radius);
  std::size_t smaller = 0;
  for (const float r : fast.radius) smaller += r < 0.2f ? 1u : 0u;
  CHECK(smaller > 100);
}

}  // namespace
}  // namespace psf
