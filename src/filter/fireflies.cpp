#include "filter/fireflies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/lists.h"
#include "filter/sum.h"
#include "search/compact_order.h"
#include "search/search.h"

namespace psf::filter {
namespace {

// Measured in README.md, "Fireflies".
constexpr double kOrdinary = 8;     // times m_j: what is brighter begins to be a firefly
constexpr double kLevel = 4;        // times brighter than that: nothing is kept; its kind is within
constexpr std::size_t kOfKind = 4;  // R_j reaches so many others of its kind
constexpr float kFarthest = 4;      // R_j is at most so many r_j
constexpr float kNearest = 0.5f;    // and at least so many, but for what is dense:
constexpr float kDense = 2;         // at most so many distances to the last of its kind

constexpr float kHair = 1 + 1e-6f;  // so that the last of its kind is within R_j

constexpr std::size_t kFireflyGrain = 4096, kReachGrain = 64;

// Whether each of two records could have brought what the other did.
bool alike(const Problem& p, std::uint32_t i, std::uint32_t j) {
  return p.weights.pass(i, j, p.radius[i]) && p.weights.pass(j, i, p.radius[j]);
}

// The mean of the roots of luminance in the ball of every query, which one bright source in it hardly
// moves.
std::vector<Rgb> mean_roots(const Problem& problem, Engine& engine, std::span<const Rgb> values) {
  std::vector<Rgb> roots(values.size(), Rgb(0, 0, 0)), means(values.size(), Rgb(0, 0, 0));
  for (const std::uint32_t j : problem.roles.sources) {
    roots[j] = Rgb(std::sqrt(std::max(luminance(values[j]), 0.0f)), 0, 0);
  }
  std::vector<std::uint32_t> neighbors(values.size());
  Statistics unused;
  const Averaged one{roots, means};
  engine.apply({&one, 1}, BallFit::mean, false, neighbors, unused);
  return means;
}

// The share of a value of luminance y that is kept; `ordinary`: m_j.
double kept_of(double y, double ordinary, const FireflyRule& rule, double n) {
  if (!(y > 0)) return 1;
  if (rule.kind == FireflyRule::Kind::clamp) {
    return std::min(1.0, rule.limit * std::sqrt(n) * ordinary / y);
  }
  const double levels = std::log2(y / (kOrdinary * ordinary)) / std::log2(kLevel);
  return 1 - std::clamp(levels, 0.0, 1.0);
}

}  // namespace

Fireflies::Fireflies(const Problem& problem, Engine& engine, std::span<const Rgb> values,
                     const Parameters& parameters, double n)
    : kept_(values.size(), 1.0f) {
  find(problem, values, mean_roots(problem, engine, values), parameters.fireflies, n);
  if (parameters.fireflies.spreads() && !records_.empty()) {
    find_receivers(problem, parameters.engine);
  }
}

void Fireflies::find(const Problem& problem, std::span<const Rgb> values,
                     std::span<const Rgb> roots, const FireflyRule& rule, double n) {
  for (const std::uint32_t j : problem.roles.sources) {
    const double y = double{luminance(values[j])}, root = double{roots[j].x};
    light_ += y;
    const auto kept = static_cast<float>(kept_of(y, root * root, rule, n));
    if (kept == 1) continue;
    kept_[j] = kept;
    light_apart_ += (1 - double{kept}) * y;
    records_.push_back(j);
  }
  records_ = search::compact_order(problem.records.position, records_);
  for (const std::uint32_t j : records_) {
    luminance_.push_back(luminance(values[j]));
    ordinary_.push_back(double{roots[j].x} * double{roots[j].x});
  }
}

Firefly Fireflies::operator[](std::size_t g) const {
  const std::uint32_t j = records_[g];
  return {j,        luminance_[g],           ordinary_[g],
          kept_[j], gives() ? reach_[g] : 0, gives() ? inverse_[g] : 0};
}

void Fireflies::to_world(const Scaled& scaled) {
  for (float& reach : reach_) reach = scaled.to_world(reach);
}

std::vector<float> Fireflies::reaches(const Problem& problem, EngineKind engine) const {
  const std::span<const Vec3> x = problem.records.position;
  std::vector<Vec3> positions;
  for (const std::uint32_t j : records_) positions.push_back(x[j]);
  const std::unique_ptr<search::Search> search = search::make_search(search_of(engine), positions);
  std::vector<float> reach(records_.size());
  core::parallel_for(reach.size(), kReachGrain, [&](std::size_t begin, std::size_t end) {
    core::throw_if_interrupted("no picture was written");
    std::vector<search::Neighbor> nearest;
    for (std::size_t g = begin; g < end; ++g) {
      const std::uint32_t j = records_[g];
      const float r_j = problem.radius[j], farthest = kFarthest * r_j;
      float last = std::numeric_limits<float>::infinity();
      for (std::size_t count = 4 * kOfKind;; count *= 4) {
        search->nearest(x[j], count, nearest);
        std::size_t found = 0;
        for (const search::Neighbor& near : nearest) {
          const bool is_kind =
              near.index != g && kLevel * double{luminance_[near.index]} >= double{luminance_[g]};
          if (!is_kind || !alike(problem, j, records_[near.index]) || ++found < kOfKind) continue;
          last = kHair * std::sqrt(near.d_sq);
          break;
        }
        const bool is_all = nearest.size() < count;
        if (found == kOfKind || is_all || !(nearest.back().d_sq < farthest * farthest)) break;
      }
      reach[g] = std::min(std::max(last, std::min(kNearest * r_j, kDense * last)), farthest);
    }
  });
  return reach;
}

void Fireflies::find_receivers(const Problem& problem, EngineKind engine) {
  reach_ = reaches(problem, engine);
  std::vector<std::vector<std::uint32_t>> receivers(records_.size());
  inverse_.resize(records_.size());
  make_lists(engine, problem, records_, reach_)->each([&](std::size_t g, auto near) {
    const std::uint32_t j = records_[g];
    receivers[g].push_back(j);
    std::uint64_t sources = 1;  // N_j: as in a mean, sources stand for the queries around them
    for (const std::uint32_t i : near) {
      if (i == j || !alike(problem, i, j)) continue;
      receivers[g].push_back(i);
      if (problem.roles.of[i] == Role::source) ++sources;
    }
    inverse_[g] = 1 / static_cast<double>(sources);
  });

  first_.assign(problem.records.size() + 1, 0);
  for (const auto& some : receivers) {
    for (const std::uint32_t i : some) ++first_[i + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  givers_.resize(first_.back());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t g = 0; g < receivers.size(); ++g) {
    for (const std::uint32_t i : receivers[g]) givers_[next[i]++] = static_cast<std::uint32_t>(g);
    receivers[g] = {};
  }
}

void Fireflies::give(std::span<const Rgb> values, std::span<Rgb> out) const {
  core::parallel_for(out.size(), kFireflyGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Sum sum;
      each_giver(static_cast<std::uint32_t>(i),
                 [&](std::uint32_t j, double share) { sum.add(values[j], share); });
      out[i] = sum.over(1);
    }
  });
}

void Fireflies::add_to(Statistics& statistics) const {
  statistics.fireflies += records_.size();
  statistics.light += light_;
  statistics.light_apart += light_apart_;
}

}  // namespace psf::filter
