#include "filter/estimators/adaptive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/engine/ring_engine.h"
#include "filter/estimators/agreement.h"
#include "search/search.h"

namespace psf::filter {
namespace {

// The number of radii: r_i 2^(-k/2) for k = 0 ... kAdaptiveRadii - 1. The least is above the share
// of r_i that parameters/estimators.h names.
constexpr std::size_t kAdaptiveRadii = 8;

// Ascending, the last one 1.
std::array<double, kAdaptiveRadii> shares_of_radius() {
  std::array<double, kAdaptiveRadii> shares;
  for (std::size_t k = 0; k < kAdaptiveRadii; ++k)
    shares[k] = std::exp2(-0.5 * static_cast<double>(kAdaptiveRadii - 1 - k));
  return shares;
}

// What the engine adds up: luminance times a power of two, and its square as two floats, whose sum
// is all but exact. The power is that at which floats hold the squares; the test knows no unit.
// None where there is no such power for all.
std::optional<std::vector<Rgb>> luminances(const Problem& problem, std::span<const Rgb> values) {
  constexpr int kLargest = 40, kLeast = -50;                          // exponents
  float largest = 0, least = std::numeric_limits<float>::infinity();  // luminances that are not 0
  for (const std::uint32_t j : problem.roles.sources) {
    const float y = std::abs(luminance(values[j]));
    largest = std::max(largest, y);
    if (y > 0) least = std::min(least, y);
  }
  const int exponent = largest > 0 ? kLargest - std::ilogb(largest) : 0;
  if (largest > 0 && exponent + std::ilogb(least) < kLeast) return std::nullopt;
  std::vector<Rgb> result(values.size(), Rgb(0, 0, 0));
  for (const std::uint32_t j : problem.roles.sources) {
    const float y = std::ldexp(luminance(values[j]), exponent);
    const double square = double{y} * double{y};
    const auto upper = static_cast<float>(square);
    result[j] = Rgb(y, upper, static_cast<float>(square - double{upper}));
  }
  return result;
}

// All radii from one traversal; false where the fast engine does not take records or values.
bool in_one_traversal(const Problem& problem, std::span<const Rgb> values, double agree,
                      std::span<float> out) {
  const std::array<double, kAdaptiveRadii> shares = shares_of_radius();
  const std::vector<double> basis(problem.radius.begin(), problem.radius.end());
  const std::optional<std::vector<Rgb>> averaged = luminances(problem, values);
  if (!averaged) return false;
  engine::RingEngine rings(problem, shares, basis);
  if (!rings.is_moderate()) return false;
  rings.set_values(*averaged);
  constexpr std::size_t kGrain = engine::RingEngine::kGrain;
  core::parallel_for(rings.queries().size(), kGrain, [&](std::size_t begin, std::size_t end) {
    core::throw_if_interrupted("no picture was written");
    std::array<Statistics, kAdaptiveRadii> unused;
    rings.average(begin, end, unused, [&](const engine::RingEngine::Results& results) {
      std::array<Moments, kAdaptiveRadii> balls;
      for (std::size_t k = 0; k < balls.size(); ++k) {
        const double* sums = &results.sums[4 * k];
        balls[k] = {results.neighbors[k], sums[0], sums[1] + sums[2]};
      }
      out[results.query] = rings.radius(results.query, last_that_agrees(balls, agree));
    });
  });
  return true;
}

// The same as anyone would write it first: a search for the largest ball of each query.
class Plain {
 public:
  Plain(EngineKind kind, const Problem& problem, std::span<const Rgb> values, double agree)
      : p_(problem), values_(values), agree_(agree), shares_(shares_of_radius()) {
    std::vector<Vec3> positions;
    for (const std::uint32_t j : p_.roles.sources) positions.push_back(p_.records.position[j]);
    search_ = search::make_search(search_of(kind), positions);
  }

  void set_radii(std::span<float> out) const {
    const std::vector<std::uint32_t>& queries = p_.roles.queries;
    core::parallel_for(queries.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      std::vector<search::Neighbor> found;
      for (std::size_t q = begin; q < end; ++q) out[queries[q]] = radius(queries[q], found);
    });
  }

 private:
  static constexpr std::size_t kGrain = 256;  // queries

  [[nodiscard]] float radius(std::uint32_t i, std::vector<search::Neighbor>& found) const {
    std::array<float, kAdaptiveRadii> radii;
    std::array<Moments, kAdaptiveRadii> balls;
    for (std::size_t k = 0; k < radii.size(); ++k) {
      radii[k] = static_cast<float>(shares_[k] * double{p_.radius[i]});
      if (p_.roles.of[i] == Role::source) add(i, balls[k]);
    }
    search_->within(p_.records.position[i], radii.back() * radii.back(), found);
    for (const search::Neighbor& neighbor : found) {
      const std::uint32_t j = p_.roles.sources[neighbor.index];
      if (j == i) continue;
      for (std::size_t k = 0; k < radii.size(); ++k) {
        if (!search::chi_ball(neighbor.d_sq, radii[k] * radii[k])) continue;
        if (p_.weights.pass(i, j, radii[k])) add(j, balls[k]);
      }
    }
    return radii[last_that_agrees(balls, agree_)];
  }
  void add(std::uint32_t j, Moments& ball) const {
    const double y = double{luminance(values_[j])};
    ++ball.count;
    ball.sum += y;
    ball.sum_sq += y * y;
  }

  const Problem& p_;
  std::span<const Rgb> values_;
  double agree_;
  std::array<double, kAdaptiveRadii> shares_;
  std::unique_ptr<search::Search> search_;
};

// r_i of every query; 0 for other records. The same for any engine.
std::vector<float> adaptive_radii(const Problem& problem, std::span<const Rgb> values,
                                  const Parameters& parameters) {
  const EngineKind kind = parameters.engine;
  std::vector<float> radii(problem.records.size(), 0.0f);
  if (kind != EngineKind::flann || !in_one_traversal(problem, values, parameters.agree, radii)) {
    Plain(kind, problem, values, parameters.agree).set_radii(radii);
  }
  return radii;
}

}  // namespace

Estimates adaptive(const MethodInput& input) {
  return apply_engine(input, {.radii = adaptive_radii, .engine = ball_engine});
}

}  // namespace psf::filter
