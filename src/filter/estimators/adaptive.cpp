#include "filter/estimators/adaptive.h"

#include <array>
#include <cmath>
#include <memory>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/engine/ring_engine.h"
#include "filter/estimators/agreement.h"

namespace psf::filter {
namespace {

// Ascending, the last one 1.
std::array<double, kAdaptiveRadii> shares_of_radius() {
  std::array<double, kAdaptiveRadii> shares;
  for (std::size_t k = 0; k < kAdaptiveRadii; ++k)
    shares[k] = std::exp2(-0.5 * static_cast<double>(kAdaptiveRadii - 1 - k));
  return shares;
}

Moments moments_of(const Rgb& average, std::uint32_t count) {
  return {count, double{average.x}, double{average.y}};
}

// What the engines average: luminance and its square.
std::vector<Rgb> luminances(const Problem& problem, std::span<const Rgb> values) {
  std::vector<Rgb> result(values.size(), Rgb(0, 0, 0));
  for (const std::uint32_t j : problem.roles.sources) {
    const float y = luminance(values[j]);
    result[j] = Rgb(y, y * y, 0);
  }
  return result;
}

// All radii from one traversal; false where the fast engine does not take the values.
bool in_one_traversal(const Problem& problem, std::span<const Rgb> values, double agree,
                      std::span<float> out) {
  const std::array<double, kAdaptiveRadii> shares = shares_of_radius();
  const std::vector<double> basis(problem.radius.begin(), problem.radius.end());
  engine::RingEngine rings(problem, shares, basis);
  if (!rings.is_moderate()) return false;
  rings.set_values(values);
  constexpr std::size_t kGrain = engine::RingEngine::kGrain;
  core::parallel_for(rings.queries().size(), kGrain, [&](std::size_t begin, std::size_t end) {
    core::throw_if_interrupted("no picture was written");
    std::array<Statistics, kAdaptiveRadii> unused;
    rings.average(begin, end, unused, [&](const engine::RingEngine::Results& results) {
      std::array<Moments, kAdaptiveRadii> balls;
      for (std::size_t k = 0; k < balls.size(); ++k)
        balls[k] = moments_of(results.average[k], results.neighbors[k]);
      out[results.query] = rings.radius(results.query, last_that_agrees(balls, agree));
    });
  });
  return true;
}

// The same by any engine, a radius after the other.
void one_by_one(search::Kind kind, const Problem& problem, std::span<const Rgb> values,
                double agree, std::span<float> out) {
  const std::array<double, kAdaptiveRadii> shares = shares_of_radius();
  std::vector<float> radius(problem.radius.size());
  const Problem varied{problem.records, problem.roles, radius, problem.weights, {}};
  const std::unique_ptr<Engine> engine = make_engine(kind, varied);
  std::vector<Moments> balls(radius.size());
  std::vector<Rgb> averages(radius.size());
  std::vector<std::uint32_t> counts(radius.size());
  std::vector<bool> stopped(radius.size());
  for (std::size_t k = 0; k < kAdaptiveRadii; ++k) {
    for (std::size_t i = 0; i < radius.size(); ++i)
      radius[i] = static_cast<float>(shares[k] * double{problem.radius[i]});
    Statistics unused;
    engine->average(values, false, averages, counts, unused);
    for (const std::uint32_t i : problem.roles.queries) {
      const Moments larger = moments_of(averages[i], counts[i]);
      stopped[i] = stopped[i] || (k > 0 && !agrees(balls[i], larger, agree));
      if (stopped[i]) continue;
      balls[i] = larger;
      out[i] = radius[i];
    }
  }
}

}  // namespace

std::vector<float> adaptive_radii(search::Kind kind, const Problem& problem,
                                  std::span<const Rgb> values, double agree) {
  const std::vector<Rgb> averaged = luminances(problem, values);
  std::vector<float> radii(problem.records.size(), 0.0f);
  const bool fast = kind == search::Kind::flann;
  if (!fast || !in_one_traversal(problem, averaged, agree, radii))
    one_by_one(kind, problem, averaged, agree, radii);
  return radii;
}

}  // namespace psf::filter
