#include "filter/many_radii.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/engine/ring_engine.h"
#include "filter/estimators/density.h"
#include "filter/estimators/disk.h"
#include "filter/inputs.h"
#include "filter/kinds.h"
#include "filter/radius.h"
#include "filter/scaled.h"

namespace psf::filter {
namespace {

using core::Clock;
using core::seconds_since;

// The most radii that share a traversal: their sums for 16 queries fit a second-level cache.
constexpr std::size_t kMostRings = 256;

// Distinct scales, ascending, and where each radius is among them.
struct Scales {
  std::vector<double> values;
  std::vector<std::size_t> of;

  Scales(std::span<const Radius> radii, double n) {
    for (const Radius& radius : radii) values.push_back(radius_scale(radius, n));
    const std::vector<double> all = values;
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    for (const double scale : all) {
      of.push_back(static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), scale) -
                                            values.begin()));
    }
  }
  // The least scale that is not 0, as a share of the largest scale.
  [[nodiscard]] double least_share() const {
    const auto least = std::upper_bound(values.begin(), values.end(), 0.0);
    return least == values.end() ? 1 : *least / values.back();
  }
  [[nodiscard]] bool can_share() const { return values.back() > 0 && values.size() <= kMostRings; }
};

bool can_share(const Parameters& parameters) {
  return parameters.iterations == 1 && parameters.engine == EngineKind::flann &&
         !parameters.count_refusals && parameters.fit == BallFit::mean &&
         parameters.fireflies.keeps() && info(parameters.estimator).shares_traversal;
}

class Many {
 public:
  Many(const Records& records, const Block& block, const Parameters& parameters,
       std::span<const Radius> radii, Receiver& receiver)
      : r_(records), block_(block), parameters_(parameters), radii_(radii), receiver_(receiver) {
    result_.statistics.resize(radii.size());
  }

  ManyEstimates run() {
    const Scales scales(radii_, block_.n);
    if (!can_share(parameters_) || !scales.can_share() || !in_one_traversal(scales)) one_by_one();
    return std::move(result_);
  }

 private:
  // Returns false where the fast engine does not accept the values.
  bool in_one_traversal(const Scales& scales) {
    const auto start = Clock::now();
    require_channels(r_, parameters_);
    std::vector<double> basis(r_.size());
    std::vector<float> largest(r_.size());
    for (std::size_t i = 0; i < r_.size(); ++i) {
      basis[i] = basis_of(radii_[0], r_, block_, i);
      largest[i] = static_cast<float>(scales.values.back() * basis[i]);
    }
    const Scaled scaled(r_, largest, scales.least_share());
    // Radii too far apart for one unit have one each, as in runs of their own.
    if (!scaled.fits() && Scaled(r_, largest).fits()) return false;
    for (double& f : basis) f = std::ldexp(f, scaled.exponent());
    const Records& records = scaled.records();
    Statistics counts;
    Roles roles = find_roles(records, block_, parameters_, counts);
    if (info(parameters_.estimator).is_of_photons) {
      const PhotonProblem photons(records, roles, scaled.radius(), parameters_.weights, counts);
      if (!photons.has_pairs()) return false;
      return share(photons.problem(), photons.values(), roles, scales, basis, counts, start);
    }
    if (roles.sources.empty()) return false;
    std::vector<float> area;
    if (info(parameters_.estimator).is_over_area) area = disk_areas(records, roles, block_);
    const Weights weights(records, terms_in_use(records, parameters_.weights));
    const Problem problem{records, roles, scaled.radius(), weights, area};
    std::vector<Rgb> divided;
    if (parameters_.demodulate) divided = demodulated(r_.contribution, r_, roles);
    return share(problem, parameters_.demodulate ? std::span<const Rgb>(divided) : r_.contribution,
                 roles, scales, basis, counts, start);
  }

  // `roles` and `counts` are those of the records, `values` those of the problem.
  bool share(const Problem& problem, std::span<const Rgb> values, Roles& roles,
             const Scales& scales, std::span<const double> basis, Statistics& counts,
             Clock::time_point start) {
    engine::RingEngine engine(problem, scales.values, basis);
    if (!engine.is_moderate()) return false;
    engine.set_values(values);
    counts.seconds_index = seconds_since(start);

    const auto filter_start = Clock::now();
    std::vector<Statistics> by_scale(scales.values.size());
    traverse(engine, roles, scales, by_scale);
    counts.seconds_filter = seconds_since(filter_start);
    for (std::size_t k = 0; k < radii_.size(); ++k) {
      result_.statistics[k] = counts;
      result_.statistics[k] += by_scale[scales.of[k]];
    }
    result_.roles = std::move(roles.of);
    return true;
  }

  void traverse(const engine::RingEngine& engine, const Roles& roles, const Scales& scales,
                std::vector<Statistics>& by_scale) {
    constexpr std::size_t kGrain = engine::RingEngine::kGrain;
    const std::span<const std::uint32_t> queries = engine.queries();
    receiver_.set_roles(roles.of);
    for_slabs(queries, kGrain, [&](std::size_t first, std::size_t count) {
      std::vector<std::vector<Statistics>> parts(core::range_count(count, kGrain));
      core::parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
        const std::size_t number = begin / kGrain, radii = radii_.size();
        std::vector<Rgb> c_bar((end - begin) * radii);
        std::span<Rgb> to = c_bar;
        parts[number].resize(by_scale.size());
        engine.average(first + begin, first + end, parts[number],
                       [&](const engine::RingEngine::Results& results) {
                         finish(engine, roles, scales, results, to.first(radii));
                         to = to.subspan(radii);
                       });
        // All at once: in turn they would drive each other from the first-level cache (8%).
        receiver_.take(number, 0, radii, c_bar);
      });
      for (const std::vector<Statistics>& part : parts) {
        for (std::size_t k = 0; k < by_scale.size(); ++k) by_scale[k] += part[k];
      }
    });
  }

  void finish(const engine::RingEngine& engine, const Roles& roles, const Scales& scales,
              const engine::RingEngine::Results& results, std::span<Rgb> c_bar) const {
    const EstimatorInfo& estimator = info(parameters_.estimator);
    if (!parameters_.demodulate && !estimator.is_over_area && !estimator.is_of_photons) {
      for (std::size_t k = 0; k < c_bar.size(); ++k) c_bar[k] = results.average[scales.of[k]];
      return;
    }
    const std::uint32_t i = results.query;
    const bool source = roles.of[i] == Role::source;
    for (std::size_t k = 0; k < c_bar.size(); ++k) {
      const std::size_t from = scales.of[k];
      c_bar[k] = finished(results.average[from], results.neighbors[from], source,
                          engine.radius(i, from), r_.contribution[i], r_, i, parameters_);
    }
  }

  // Calls visit(first, count) for queries [first, first + count), slab after slab.
  template <class Visit>
  void for_slabs(std::span<const std::uint32_t> queries, std::size_t grain, const Visit& visit) {
    for (std::size_t first = 0; first < queries.size(); first += Receiver::kMostQueries) {
      core::throw_if_interrupted("no picture was written");
      const std::size_t count = std::min(Receiver::kMostQueries, queries.size() - first);
      receiver_.begin(queries.subspan(first, count), grain);
      visit(first, count);
      receiver_.end();
    }
  }

  void one_by_one() {
    std::vector<float> radius;
    std::vector<std::uint32_t> queries;
    std::vector<Rgb> c_bar;
    for (std::size_t k = 0; k < radii_.size(); ++k) {
      Parameters parameters = parameters_;
      parameters.radius = radii_[k];
      radii(parameters.radius, r_, block_, radius);
      const Estimates average = filter::estimate(r_, radius, block_, parameters);
      queries.clear();
      c_bar.clear();
      for (std::size_t i = 0; i < r_.size(); ++i) {
        const Role role = average.roles[i];
        if (!is_query(role)) continue;
        queries.push_back(static_cast<std::uint32_t>(i));
        c_bar.push_back(average.c_bar[i]);
      }
      receiver_.set_roles(average.roles);
      for_slabs(queries, Receiver::kMostQueries, [&](std::size_t first, std::size_t count) {
        receiver_.take(0, k, 1, std::span(c_bar).subspan(first, count));
      });
      result_.statistics[k] = average.statistics;
      result_.roles = average.roles;
    }
  }

  const Records& r_;  // world units
  const Block& block_;
  const Parameters& parameters_;
  std::span<const Radius> radii_;
  Receiver& receiver_;
  ManyEstimates result_;
};

}  // namespace

ManyEstimates estimate_many(const Records& records, const Block& block,
                            const Parameters& parameters, std::span<const Radius> radii,
                            Receiver& receiver) {
  assert(!radii.empty());
  if (!has_kinds_apart(records)) return Many(records, block, parameters, radii, receiver).run();
  require_channels(records, parameters);
  const std::vector<KindRun> runs = runs_of_kinds(records, parameters);
  ManyEstimates result = Many(runs[0].records, block, runs[0].parameters, radii, receiver).run();
  const ManyEstimates volumes =
      Many(runs[1].records, block, runs[1].parameters, radii, receiver).run();
  merge_volumes(records, result.roles, volumes.roles);
  for (std::size_t k = 0; k < radii.size(); ++k) result.statistics[k] += volumes.statistics[k];
  return result;
}

}  // namespace psf::filter
