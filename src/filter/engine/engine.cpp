#include "filter/engine/engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "filter/engine/adopt.h"
#include "filter/engine/kernel.h"
#include "filter/engine/tree.h"
#include "filter/sum.h"
#include "search/box_index.h"
#include "search/compact_order.h"

namespace psf::filter::engine {
namespace {

// Queries that share a search: as many as a parent has records.
constexpr std::size_t kGrain = kWidth * kWidth;

std::vector<search::Box> boxes_of(const Tree& tree) {
  std::vector<search::Box> boxes;
  for (std::size_t k = 0; k < tree.nodes(kParents); ++k) boxes.push_back(tree.box(kParents, k));
  return boxes;
}

// Products and sums of products of values up to this are finite floats, which the bounds rely on.
constexpr float kLargest = 1e18f;

bool is_moderate(const Vec3& v) {
  return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z)) <= kLargest;
}

class TreeEngine final : public Engine {
 public:
  explicit TreeEngine(const Problem& problem)
      : p_(problem),
        order_(search::compact_order(problem.records.position, problem.roles.queries)),
        tree_(problem.records, sources_of(problem, order_), ColumnPlan(problem.weights.terms())),
        all_sources_(order_.size() == tree_.size()),
        index_(is_moderate() ? boxes_of(tree_) : std::vector<search::Box>()) {}

  // Whether the values of all who take part are small enough.
  [[nodiscard]] bool is_moderate() const {
    if (!tree_.all_within(kLargest)) return false;
    if (all_sources_) return true;
    const Records& r = p_.records;
    const ColumnPlan& plan = tree_.plan();
    return std::all_of(order_.begin(), order_.end(), [&](std::uint32_t i) {
      return engine::is_moderate(r.position[i]) &&
             (!plan.normal || engine::is_moderate(r.normal[i])) &&
             (!plan.reflectance || engine::is_moderate(r.reflectance[i])) &&
             (!plan.direction || engine::is_moderate(r.direction[i]));
    });
  }

  void average(std::span<const Rgb> values, bool count_refusals, std::span<Rgb> out,
               std::span<std::uint32_t> neighbors, Statistics& statistics) override {
    tree_.set_values(values, p_.area);
    std::vector<Statistics> parts(core::range_count(order_.size(), kGrain));
    core::parallel_for(order_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      core::throw_if_interrupted("no picture was written");
      const std::span queries = std::span<const std::uint32_t>(order_).subspan(begin, end - begin);
      std::vector<std::uint32_t> nodes;
      search_for(begin, queries, nodes);
      Statistics& counts = parts[begin / kGrain];
      for (std::size_t first = 0; first < queries.size(); first += kWidth) {
        const std::span some = queries.subspan(first, std::min(kWidth, queries.size() - first));
        Own own;
        Packet packet;
        fill(some, (begin + first) / kWidth, own, packet);
        engine::average(tree_, p_.weights.terms(), nodes, packet);
        if (count_refusals) count(some, nodes, packet, counts);
        for (std::size_t k = 0; k < some.size(); ++k) {
          neighbors[some[k]] = finish(packet, k, some[k], values, out[some[k]], counts);
        }
      }
    });
    for (const Statistics& part : parts) statistics += part;
  }

 private:
  static std::vector<std::uint32_t> sources_of(const Problem& problem,
                                               const std::vector<std::uint32_t>& queries) {
    std::vector<std::uint32_t> sources;
    if (problem.roles.sources.size() == queries.size()) return queries;
    sources.reserve(problem.roles.sources.size());
    std::copy_if(queries.begin(), queries.end(), std::back_inserter(sources),
                 [&](std::uint32_t i) { return problem.roles.of[i] == Role::source; });
    return sources;
  }

  // The nodes near the queries from `begin` on.
  void search_for(std::size_t begin, std::span<const std::uint32_t> queries,
                  std::vector<std::uint32_t>& nodes) const {
    float r = 0;
    for (const std::uint32_t i : queries) r = std::max(r, p_.radius[i]);
    index_.within(all_sources_ ? tree_.box(kParents, begin / kGrain) : box_of(queries), r * r,
                  nodes);
  }
  [[nodiscard]] search::Box box_of(std::span<const std::uint32_t> queries) const {
    search::Box box{p_.records.position[queries[0]], p_.records.position[queries[0]]};
    for (const std::uint32_t i : queries) {
      const Vec3& x = p_.records.position[i];
      for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], x[axis]);
        box.high[axis] = std::max(box.high[axis], x[axis]);
      }
    }
    return box;
  }

  // Columns and bounds of a packet that is no group of the tree.
  struct Own {
    alignas(64) float columns[kMaxColumns * kWidth];
    alignas(64) float low[kMaxColumns * kWidth];  // every kWidth-th counts
    alignas(64) float high[kMaxColumns * kWidth];
  };

  void fill(std::span<const std::uint32_t> queries, std::size_t number, Own& own,
            Packet& packet) const {
    const ColumnPlan& plan = tree_.plan();
    if (all_sources_) {
      packet.columns = tree_.group(number);
      packet.low = tree_.bounds(kGroups, number / kWidth) + number % kWidth;
      packet.high = packet.low + plan.count * kWidth;
    } else {
      plan.gather(p_.records, queries, own.columns);
      extremes(plan, plan.count, own.columns, own.columns, own.low, own.high);
      packet.columns = own.columns;
      packet.low = own.low;
      packet.high = own.high;
    }
    const float plane = p_.weights.terms().plane.value_or(0);
    for (std::size_t k = 0; k < kWidth; ++k) {
      const float r_i = p_.radius[queries[std::min(k, queries.size() - 1)]];
      packet.r_sq[k] = k < queries.size() ? r_i * r_i : 0;
      const float reach = plane * r_i;
      packet.plane_reach[k] = std::isnan(reach) ? -1 : reach;  // 0 times infinity: nothing passes
      packet.count[k] = 0;
      for (auto& sum : packet.sum) sum[k] = 0;
    }
  }

  std::uint32_t finish(const Packet& packet, std::size_t k, std::uint32_t i,
                       std::span<const Rgb> values, Rgb& out, Statistics& counts) const {
    Sum sum{packet.sum[0][k], packet.sum[1][k], packet.sum[2][k]};
    auto count = static_cast<std::uint32_t>(packet.count[k]);
    // The walk met i like any other source; w_ii = 1 whatever the terms say.
    if (packet.met_itself[k] == 0 && (all_sources_ || p_.roles.of[i] == Role::source)) {
      sum.add(values[i], p_.area.empty() ? 1 : double{p_.area[i]});
      ++count;
    }
    counts.add_query(count);
    out = count > 0 ? estimate(sum, count, !p_.area.empty(), p_.radius[i], values[i])
                    : average_of(adopt(tree_, index_, p_, i), values, counts);
    return count;
  }

  void count(std::span<const std::uint32_t> queries, std::span<const std::uint32_t> nodes,
             const Packet& packet, Statistics& statistics) const {
    PairCounts counts;
    count_pairs(tree_, p_.weights.terms(), nodes, packet, counts);
    statistics.candidates += counts.candidates;
    for (std::size_t k = 0; k < kTermCount; ++k) statistics.refused[k] += counts.refused[k];
    for (const std::uint32_t i : queries) {
      if (p_.roles.of[i] != Role::source) continue;
      const float r_i = p_.radius[i];
      if (!search::chi_ball(0, r_i * r_i)) {
        ++statistics.candidates;
        continue;
      }
      const std::uint32_t refusers = p_.weights.refusers(i, i, r_i);
      for (std::size_t k = 0; k < kTermCount; ++k) statistics.refused[k] -= (refusers >> k) & 1;
    }
  }

  const Problem& p_;
  std::vector<std::uint32_t> order_;  // the queries in a compact order
  Tree tree_;
  bool all_sources_;        // every query is one: then a packet is a group, a range a parent
  search::BoxIndex index_;  // over the parents
};

}  // namespace

PairCounts& PairCounts::operator+=(const PairCounts& other) {
  candidates += other.candidates;
  for (std::size_t k = 0; k < kTermCount; ++k) refused[k] += other.refused[k];
  return *this;
}

std::unique_ptr<Engine> make(const Problem& problem) {
  auto engine = std::make_unique<TreeEngine>(problem);
  if (!engine->is_moderate()) return nullptr;
  return engine;
}

}  // namespace psf::filter::engine
