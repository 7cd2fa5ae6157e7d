#include "filter/fireflies.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/receivers.h"
#include "filter/sum.h"
#include "search/compact_order.h"

namespace psf::filter {
namespace {

// Measured in README.md, "Fireflies".
constexpr double kOrdinary = 8;  // times m_j: what is brighter begins to be a firefly
constexpr double kLevel = 4;     // times brighter than that: nothing is kept
constexpr std::size_t kFireflyGrain = 4096;

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
          kept_[j], gives() ? reach_[g] : 0, gives() ? shares_[g] : 0};
}

void Fireflies::to_world(const Scaled& scaled) {
  for (float& reach : reach_) reach = scaled.to_world(reach);
}

void Fireflies::find_receivers(const Problem& problem, EngineKind engine) {
  Receivers found = filter::find_receivers(problem, engine, {records_, luminance_});
  keep_even(found);

  first_.assign(kept_.size() + 1, 0);
  for (const auto& some : found.of) {
    for (const std::uint32_t i : some) ++first_[i + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  givers_.resize(first_.back());
  std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t g = 0; g < found.of.size(); ++g) {
    for (const std::uint32_t i : found.of[g]) givers_[next[i]++] = static_cast<std::uint32_t>(g);
    found.of[g] = {};
  }
  reach_ = std::move(found.reach);
  shares_ = std::move(found.shares);
}

void Fireflies::keep_even(Receivers& found) {
  std::size_t left = 0;
  for (std::size_t g = 0; g < records_.size(); ++g) {
    const std::uint32_t j = records_[g];
    if (found.of[g].empty()) {
      light_apart_ -= (1 - double{kept_[j]}) * double{luminance_[g]};
      kept_[j] = 1;
      continue;
    }
    records_[left] = j;
    luminance_[left] = luminance_[g];
    ordinary_[left] = ordinary_[g];
    found.reach[left] = found.reach[g];
    found.shares[left] = found.shares[g];
    std::swap(found.of[left++], found.of[g]);
  }
  records_.resize(left);
  luminance_.resize(left);
  ordinary_.resize(left);
  found.reach.resize(left);
  found.shares.resize(left);
  found.of.resize(left);
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
