// [control] is unbiased at any radius, whatever the contributions; [average] is not.
#include "filter/estimators/control.h"

#include <cmath>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "estimator_case.h"

namespace psf {
namespace {

using filter::Estimator;
using tests::EstimatorRun;
using tests::RecordSet;

constexpr std::uint32_t kPlaneSide = 6, kPixels = kPlaneSide * kPlaneSide, kPasses = 8, kK = 4;
const std::vector<filter::CameraView> kPlaneCamera = {{kPlaneSide, kPlaneSide, 1.0 / kPlaneSide}};

// f of the plane: a step in x, a slope in y; and its mean over a pixel.
double field(double x, double y) {
  return (x < 0.4 ? 5 : 1) + 3 * y;
}
double pixel_mean(std::uint32_t pixel) {
  const double left = double(pixel % kPlaneSide) / kPlaneSide,
               low = double(pixel / kPlaneSide) / kPlaneSide;
  const double lit = std::clamp((0.4 - left) * kPlaneSide, 0.0, 1.0);
  return 5 * lit + (1 - lit) + 3 * (low + 0.5 / kPlaneSide);
}

// All passes of a picture that looks down on the unit square; c is f times noise of mean 1 with a
// long tail, as of paths.
RecordSet render(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::exponential_distribution<double> noise(1);
  RecordSet set(kPixels * kPasses);
  for (std::uint32_t i = 0; i < set.size(); ++i) {
    const std::uint32_t pixel = i % kPixels;
    const double x = (pixel % kPlaneSide + unit(random)) / kPlaneSide;
    const double y = (pixel / kPlaneSide + unit(random)) / kPlaneSide;
    set.pixel[i] = pixel;
    set.position[i] = Vec3(float(x), float(y), 0);
    set.contribution[i] = Rgb(float(field(x, y) * noise(random)), float(x), 1);
  }
  return set;
}

EstimatorRun run_of(Estimator estimator, double r0, std::uint64_t realization) {
  EstimatorRun run(estimator, r0);
  run.cameras = kPlaneCamera;
  run.passes = kPasses;
  run.parameters.sources = kK;
  run.parameters.engine = filter::EngineKind::brute;  // the fastest for so few
  run.parameters.weights = filter::WeightTerms::none();
  run.first_path = realization * kPixels * kPasses;
  return run;
}

// The mean over the paths of each pixel, red.
std::vector<double> picture(const filter::Estimates& average) {
  std::vector<double> means(kPixels);
  for (std::size_t i = 0; i < average.c_bar.size(); ++i)
    means[i % kPixels] += double{average.c_bar[i].x} / kPasses;
  return means;
}

// How many standard errors the mean picture of many realizations is off, in its worst pixel.
template <typename Realize>
double worst_deviation(std::size_t count, const std::vector<double>& truth, Realize realize) {
  std::vector<double> sum(kPixels), sum_sq(kPixels);
  for (std::size_t t = 0; t < count; ++t) {
    const std::vector<double> one = realize(t);
    for (std::size_t p = 0; p < kPixels; ++p) {
      sum[p] += one[p];
      sum_sq[p] += one[p] * one[p];
    }
  }
  double worst = 0;
  for (std::size_t p = 0; p < kPixels; ++p) {
    const double n = double(count), mean = sum[p] / n;
    const double error = std::sqrt((sum_sq[p] / n - mean * mean) / n);
    worst = std::max(worst, std::abs(mean - truth[p]) / error);
  }
  return worst;
}

constexpr double kRadii[] = {1e-4, 0.05, 0.3, 10};  // none, few, many and all in the ball

void check_renderings(std::size_t count) {
  const core::ThreadLimit one(1);  // there is too little work for two
  std::vector<double> truth(kPixels);
  for (std::uint32_t p = 0; p < kPixels; ++p) truth[p] = pixel_mean(p);
  for (const double r0 : kRadii) {
    const auto deviation = [&](Estimator estimator) {
      std::mt19937 random(1);
      return worst_deviation(count, truth, [&](std::size_t t) {
        return picture(run_of(estimator, r0, t)(render(random)));
      });
    };
    INFO("r0 " << r0);
    CHECK(deviation(Estimator::control) < 4);
    if (r0 >= 0.3) CHECK(deviation(Estimator::average) > 20);
  }
}

// So nothing has to be independent but the choice: the samples may be of any sequence.
void check_choices(std::size_t count) {
  const core::ThreadLimit one(1);
  std::mt19937 random(2);
  const RecordSet set = render(random);
  std::vector<double> truth(kPixels);
  for (std::size_t i = 0; i < set.size(); ++i)
    truth[i % kPixels] += double{set.contribution[i].x} / kPasses;
  for (const double r0 : kRadii) {
    INFO("r0 " << r0);
    CHECK(worst_deviation(count, truth, [&](std::size_t t) {
            EstimatorRun run = run_of(Estimator::control, r0, t);
            run.parameters.demodulate = t % 2 == 0;
            return picture(run(set));
          }) < 4);
  }
}

TEST_CASE("The mean over many renderings is the truth at any radius, and average's is not") {
  check_renderings(1500);
}
TEST_CASE("The mean over many choices of sources is the picture of all contributions") {
  check_choices(2000);
}
TEST_CASE("The same over very many renderings and choices", "[.][long]") {
  check_renderings(20000);
  check_choices(40000);
}

TEST_CASE("A pixel has the same number of sources as any other in a multiple of K passes") {
  std::mt19937 random(3);
  for (std::uint64_t t = 0; t < 5; ++t) {
    const filter::Estimates result = run_of(Estimator::control, 0.3, t)(render(random));
    std::vector<std::size_t> sources(kPixels);
    for (std::size_t i = 0; i < result.roles.size(); ++i)
      sources[i % kPixels] += result.roles[i] == filter::Role::source ? 1u : 0u;
    CHECK(sources == std::vector<std::size_t>(kPixels, kPasses / kK));
    CHECK(result.statistics.sources == kPixels * kPasses / kK);
  }
}

TEST_CASE("Where contributions are known to their position, the control takes the noise away") {
  // c = f(x), and the throughput is the edge of something: half of a pixel's paths see it.
  std::mt19937 random(4);
  double control = 0, plain = 0;
  for (std::uint64_t t = 0; t < 50; ++t) {
    RecordSet set = render(random);
    for (std::size_t i = 0; i < set.size(); ++i) set.contribution[i] = Rgb(4 + set.position[i].y);
    const EstimatorRun run = run_of(Estimator::control, 0.3, t);
    const filter::Estimates result = run(set);
    for (std::uint32_t p = 0; p < kPixels; ++p) {
      double all = 0, of_control = 0, of_sources = 0;
      for (std::size_t i = p; i < set.size(); i += kPixels) {
        const double x = double{set.position[i].x} * kPlaneSide, alpha = x - std::floor(x) < 0.5;
        all += alpha * double{set.contribution[i].x} / kPasses;
        of_control += alpha * double{result.c_bar[i].x} / kPasses;
        if (result.roles[i] == filter::Role::source)
          of_sources += alpha * double{set.contribution[i].x} * kK / kPasses;
      }
      control += (of_control - all) * (of_control - all);
      plain += (of_sources - all) * (of_sources - all);
    }
  }
  CHECK(control < plain / 50);
}

TEST_CASE("With every contribution there is nothing to win: c, bit for bit") {
  std::mt19937 random(5);
  const RecordSet set = render(random);
  EstimatorRun run = run_of(Estimator::control, 0.3, 0);
  run.parameters.sources = 1;
  CHECK(tests::same_bytes(run(set).c_bar, set.contribution));
}

TEST_CASE("A lattice of shaded records weighs as its share, another share is refused") {
  std::mt19937 random(6);
  RecordSet set = render(random);
  for (std::size_t i = 0; i < set.size(); ++i)
    set.flags[i] = (i % kPixels + i / kPixels) % 3 == 0 ? 3 : filter::kHasVertex;
  EstimatorRun run = run_of(Estimator::control, 0, 0);
  run.parameters.sources = 1;
  const filter::Estimates result = run(set);  // r0 = 0: no control
  for (std::size_t i = 0; i < set.size(); ++i)
    REQUIRE(result.c_bar[i].x == (set.flags[i] == 3 ? 3 * set.contribution[i].x : 0));
  CHECK(filter::shade_rate(1000000, 1000000) == 1);
  CHECK(filter::shade_rate(1000000, 250100) == 4);
  CHECK_THROWS_AS(filter::shade_rate(1000000, 400000), Error);
  CHECK_THROWS_AS(filter::shade_rate(1000000, 990000), Error);
}

}  // namespace
}  // namespace psf
