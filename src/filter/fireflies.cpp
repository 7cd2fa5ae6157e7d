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
                     const Parameters& parameters, double n) {
  find(problem, values, mean_roots(problem, engine, values), parameters.fireflies, n);
  if (parameters.fireflies.spreads() && !all_.empty()) {
    turn_round(find_receivers(problem, parameters.engine, all_), values.size());
  }
}

void Fireflies::find(const Problem& problem, std::span<const Rgb> values,
                     std::span<const Rgb> roots, const FireflyRule& rule, double n) {
  const auto bright = [&](std::uint32_t j) {
    const float y = luminance(values[j]);
    const double ordinary = double{roots[j].x} * double{roots[j].x};
    return Firefly{j, y, ordinary, static_cast<float>(kept_of(double{y}, ordinary, rule, n))};
  };
  std::vector<std::uint32_t> records;
  for (const std::uint32_t j : problem.roles.sources) {
    light_ += double{luminance(values[j])};
    if (bright(j).kept != 1) records.push_back(j);
  }
  for (const std::uint32_t j : search::compact_order(problem.records.position, records)) {
    all_.push_back(bright(j));
  }
}

void Fireflies::to_world(const Scaled& scaled) {
  for (Firefly& firefly : all_) firefly.reach = scaled.to_world(firefly.reach);
}

void Fireflies::turn_round(std::vector<std::vector<std::uint32_t>> receivers, std::size_t records) {
  first_.assign(records + 1, 0);
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
  statistics.fireflies += all_.size();
  statistics.light += light_;
  for (const Firefly& firefly : all_) {
    statistics.light_apart += (1 - double{firefly.kept}) * double{firefly.luminance};
  }
}

}  // namespace psf::filter
