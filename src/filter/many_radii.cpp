#include "filter/many_radii.h"

#include <algorithm>
#include <cassert>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "core/seconds.h"
#include "filter/engine/ring_engine.h"
#include "filter/inputs.h"
#include "filter/radius.h"

namespace psf::filter {
namespace {

using core::Clock;
using core::seconds_since;

// Radii that share a traversal at most: their sums for 16 queries fit a second-level cache.
constexpr std::size_t kMostRings = 256;

// Few, so that what one traversal writes is still in a cache when it is added to pictures.
constexpr std::size_t kRangesAThread = 4;
std::size_t queries_of_slab() {
  return engine::RingEngine::kGrain * kRangesAThread * core::thread_count();
}

// One that is filled while the one before it is handed on.
constexpr std::size_t kSlabs = 2;

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
  [[nodiscard]] bool can_share() const { return values.back() > 0 && values.size() <= kMostRings; }
};

bool can_share(const Parameters& parameters) {
  return parameters.iterations == 1 && parameters.search == search::Kind::flann &&
         !parameters.count_refusals &&
         (parameters.estimator == Estimator::average || parameters.estimator == Estimator::disk);
}

class Many {
 public:
  Many(const Records& records, const Block& block, const Parameters& parameters,
       std::span<const Radius> radii, const std::function<void(const Slab&)>& on_slab)
      : r_(records), block_(block), parameters_(parameters), radii_(radii), on_slab_(on_slab) {
    result_.statistics.resize(radii.size());
  }

  ManyAverages run() {
    const Scales scales(radii_, block_.n);
    if (!can_share(parameters_) || !scales.can_share() || !in_one_traversal(scales)) one_by_one();
    return std::move(result_);
  }

 private:
  // False where the fast engine does not take the values.
  bool in_one_traversal(const Scales& scales) {
    const auto start = Clock::now();
    require_channels(r_, parameters_);
    Statistics counts;
    Roles roles = find_roles(r_, block_, parameters_, counts);
    if (roles.sources.empty()) return false;
    std::vector<double> basis(r_.size());
    std::vector<float> largest(r_.size());
    for (std::size_t i = 0; i < r_.size(); ++i) {
      basis[i] = basis_of(radii_[0], r_, block_, i);
      largest[i] = static_cast<float>(scales.values.back() * basis[i]);
    }
    std::vector<float> area;
    if (parameters_.estimator == Estimator::disk) area = areas(r_, roles, block_);
    const Weights weights(r_, parameters_.weights);
    const Problem problem{r_, roles, largest, weights, area};
    engine::RingEngine engine(problem, scales.values, basis);
    if (!engine.is_moderate()) return false;
    std::vector<Rgb> divided;
    if (parameters_.demodulate) divided = demodulated(r_, roles);
    engine.set_values(parameters_.demodulate ? std::span<const Rgb>(divided) : r_.contribution);
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

  // A slab is handed on beside the averages of the next one.
  void traverse(const engine::RingEngine& engine, const Roles& roles, const Scales& scales,
                std::vector<Statistics>& by_scale) {
    const std::size_t columns = radii_.size(), slab = queries_of_slab();
    const std::span<const std::uint32_t> queries = engine.queries();
    std::vector<Rgb> c_bar[kSlabs];
    for (std::vector<Rgb>& one : c_bar) one.resize(std::min(slab, queries.size()) * columns);
    core::Aside hand_on;
    for (std::size_t first = 0, k = 0; first < queries.size(); first += slab, ++k) {
      core::throw_if_interrupted("no picture was written");
      std::vector<Rgb>& to = c_bar[k % kSlabs];
      const std::size_t last = std::min(first + slab, queries.size());
      average_slab(engine, roles, scales, first, last, to, by_scale);
      hand_on.wait();
      hand_on.start([this, some = queries.subspan(first, last - first), columns, &to] {
        on_slab_({some, 0, columns, std::span(to).first(some.size() * columns)});
      });
    }
    hand_on.wait();
  }

  void average_slab(const engine::RingEngine& engine, const Roles& roles, const Scales& scales,
                    std::size_t first, std::size_t last, std::span<Rgb> c_bar,
                    std::vector<Statistics>& by_scale) {
    constexpr std::size_t kGrain = engine::RingEngine::kGrain;
    const std::size_t columns = radii_.size();
    const bool is_finished = !parameters_.demodulate && parameters_.estimator == Estimator::average;
    std::vector<std::vector<Statistics>> parts(core::range_count(last - first, kGrain));
    core::parallel_for(last - first, kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<Statistics>& part = parts[begin / kGrain];
      part.resize(by_scale.size());
      std::size_t to = begin * columns;
      engine.average(first + begin, first + end, part,
                     [&](const engine::RingEngine::Results& results) {
                       const std::uint32_t i = results.query;
                       if (is_finished) {
                         for (const std::size_t from : scales.of)
                           c_bar[to++] = results.average[from];
                         return;
                       }
                       const bool source = roles.of[i] == Role::source;
                       for (std::size_t k = 0; k < columns; ++k, ++to) {
                         const std::size_t from = scales.of[k];
                         c_bar[to] = finished(results.average[from], results.neighbors[from],
                                              source, engine.radius(i, from), r_, i, parameters_);
                       }
                     });
    });
    for (const std::vector<Statistics>& part : parts) {
      for (std::size_t k = 0; k < by_scale.size(); ++k) by_scale[k] += part[k];
    }
  }

  void one_by_one() {
    std::vector<float> radius;
    std::vector<Rgb> c_bar;
    std::vector<std::uint32_t> queries;
    for (std::size_t k = 0; k < radii_.size(); ++k) {
      Parameters parameters = parameters_;
      parameters.radius = radii_[k];
      radii(parameters.radius, r_, block_, radius);
      const Average average = filter::average(r_, radius, block_, parameters);
      queries.clear();
      c_bar.clear();
      for (std::size_t i = 0; i < r_.size(); ++i) {
        const Role role = average.roles[i];
        if (role != Role::query && role != Role::source) continue;
        queries.push_back(static_cast<std::uint32_t>(i));
        c_bar.push_back(average.c_bar[i]);
      }
      on_slab_({queries, k, 1, c_bar});
      result_.statistics[k] = average.statistics;
      result_.roles = average.roles;
    }
  }

  const Records& r_;
  const Block& block_;
  const Parameters& parameters_;
  std::span<const Radius> radii_;
  const std::function<void(const Slab&)>& on_slab_;
  ManyAverages result_;
};

}  // namespace

ManyAverages average_many(const Records& records, const Block& block, const Parameters& parameters,
                          std::span<const Radius> radii,
                          const std::function<void(const Slab&)>& on_slab) {
  assert(!radii.empty());
  return Many(records, block, parameters, radii, on_slab).run();
}

std::uint64_t memory_of_slab(std::size_t radii) {
  return kSlabs * queries_of_slab() * radii * sizeof(Rgb);
}

}  // namespace psf::filter
