#include "filter/plain.h"

#include <array>
#include <optional>
#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/fit.h"
#include "filter/orphans.h"
#include "filter/sum.h"
#include "search/compact_order.h"

namespace psf::filter {
namespace {

constexpr std::size_t kPlainGrain = 256;  // queries a range

// Works on queries one after the other; one a range, so nothing is shared.
class Worker {
 public:
  Worker(const Problem& problem, const search::Search& search, std::span<const Averaged> all,
         BallFit fit, bool count_refusals)
      : p_(problem), search_(search), all_(all), fit_(fit), count_refusals_(count_refusals) {}

  // Returns how many neighbours there were.
  std::uint32_t average(std::uint32_t i) {
    const float r_i = p_.radius[i], r_sq = r_i * r_i;
    averaged_.clear();
    if (p_.roles.of[i] == Role::source) {
      averaged_.push_back(i);
      if (count_refusals_) ++counts.candidates;
    }
    if (r_sq > 0) {
      search_.within(p_.records.position[i], r_sq, found_);
      for (const search::Neighbor& neighbor : found_) {
        const std::uint32_t j = p_.roles.sources[neighbor.index];
        if (j != i && passes(i, j, r_i)) averaged_.push_back(j);
      }
    }
    const auto count = static_cast<std::uint32_t>(averaged_.size());
    counts.add_query(count);
    if (count == 0 && p_.sources_apart) {
      for (const Averaged& one : all_) one.out[i] = Rgb(0, 0, 0);
      return 0;
    }
    if (count == 0) {
      average_adopted(adopt(search_, p_, i), i, all_, counts);
      return 0;
    }
    if (fit_ == BallFit::linear && count > 1) {
      fit(i);
      return count;
    }
    const bool disk = !p_.area.empty();
    for (const auto& [values, out] : all_) {
      Sum sum;
      for (const std::uint32_t j : averaged_) sum.add(values[j], disk ? double{p_.area[j]} : 1);
      out[i] = quotient(sum, count, disk, r_i, values[i]);
    }
    return count;
  }

  Statistics counts;

 private:
  // [fit] over averaged_, from its equations.
  void fit(std::uint32_t i) {
    const FitAxes axes = fit_axes(p_.records, i, p_.radius[i]);
    const std::span<const Vec3> x = p_.records.position, y = facing(p_.records);
    FitMoments moments;
    features_.clear();
    for (const std::uint32_t j : averaged_) {
      const auto& f = features_.emplace_back(features(axes, x[j] - x[i], y[j] - y[i]));
      moments.add(f, double{luminance(all_[0].values[j])});
    }
    const Fit fit = fit_of(moments);
    std::optional<FitShares> shares;
    for (const auto& [values, out] : all_) {
      Sum mean, beside;
      for (std::size_t k = 0; k < averaged_.size(); ++k) {
        mean.add(values[averaged_[k]], 1 / moments.count);
        beside.add(values[averaged_[k]], fit.weight(features_[k]));
      }
      if (!shares) shares.emplace(mean, beside);
      out[i] = shares->taken(mean, beside);
    }
  }

  [[nodiscard]] bool passes(std::uint32_t i, std::uint32_t j, float r_i) {
    if (!count_refusals_) return p_.weights.pass(i, j, r_i);
    ++counts.candidates;
    const std::uint32_t refusers = p_.weights.refusers(i, j, r_i);
    for (std::size_t k = 0; k < kTermCount; ++k) counts.refused[k] += (refusers >> k) & 1;
    return refusers == 0;
  }

  const Problem& p_;
  const search::Search& search_;
  std::span<const Averaged> all_;
  BallFit fit_;
  bool count_refusals_;
  std::vector<search::Neighbor> found_;
  std::vector<std::uint32_t> averaged_;                  // record numbers
  std::vector<std::array<double, kFeatures>> features_;  // of averaged_
};

class PlainEngine final : public Engine {
 public:
  PlainEngine(EngineKind kind, const Problem& problem)
      : p_(problem),
        order_(search::compact_order(problem.records.position, problem.roles.queries)) {
    std::vector<Vec3> positions;
    positions.reserve(p_.roles.sources.size());
    for (const std::uint32_t j : p_.roles.sources) positions.push_back(p_.records.position[j]);
    search_ = search::make_search(search_of(kind), positions);
  }

  void apply(std::span<const Averaged> all, BallFit fit, bool count_refusals,
             std::span<std::uint32_t> neighbors, Statistics& statistics) override {
    std::vector<Statistics> parts(core::range_count(order_.size(), kPlainGrain));
    core::parallel_for(order_.size(), kPlainGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      Worker worker(p_, *search_, all, fit, count_refusals);
      for (const std::uint32_t i : std::span(order_).subspan(begin, end - begin)) {
        neighbors[i] = worker.average(i);
      }
      parts[begin / kPlainGrain] = worker.counts;
    });
    for (const Statistics& part : parts) statistics += part;
  }

 private:
  const Problem& p_;
  std::vector<std::uint32_t> order_;  // the queries in a compact order, for the cache's sake
  std::unique_ptr<search::Search> search_;
};

}  // namespace

std::unique_ptr<Engine> make_plain(EngineKind kind, const Problem& problem) {
  return std::make_unique<PlainEngine>(kind, problem);
}

}  // namespace psf::filter
