#include "filter/engine/engine.h"

#include <algorithm>
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

// Queries that share a search: as many as a node of the upper level has records.
constexpr std::size_t kGrain = kWidth * kWidth;

std::vector<search::Box> boxes_of(const Tree& tree) {
  std::vector<search::Box> boxes;
  for (std::size_t k = 0; k < tree.nodes(kLevels - 1); ++k)
    boxes.push_back(tree.box(kLevels - 1, k));
  return boxes;
}

class TreeEngine final : public Engine {
 public:
  explicit TreeEngine(const Problem& problem)
      : p_(problem),
        order_(search::compact_order(problem.records.position, problem.roles.queries)),
        tree_(problem.records, sources_of(problem, order_), ColumnPlan(problem.weights.terms())),
        index_(boxes_of(tree_)),
        all_sources_(order_.size() == tree_.size()) {}

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
        Packet packet;
        fill(some, (begin + first) / kWidth, packet);
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
    index_.within(all_sources_ ? tree_.box(kLevels - 1, begin / kGrain) : box_of(queries), r * r,
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

  void fill(std::span<const std::uint32_t> queries, std::size_t number, Packet& packet) const {
    if (all_sources_) {
      const float* group = tree_.group(number);
      std::copy(group, group + tree_.plan().count * kWidth, &packet.columns[0][0]);
    } else {
      tree_.plan().gather(p_.records, queries, &packet.columns[0][0]);
    }
    for (std::size_t k = 0; k < kWidth; ++k) {
      const std::uint32_t i = queries[std::min(k, queries.size() - 1)];
      packet.r_sq[k] = k < queries.size() ? p_.radius[i] * p_.radius[i] : 0;
      packet.plane_reach[k] = p_.weights.terms().plane.value_or(0) * p_.radius[i];
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
  search::BoxIndex index_;  // over the nodes of the upper level
  bool all_sources_;        // every query is one: then a packet is a group, and a range a node
};

}  // namespace

PairCounts& PairCounts::operator+=(const PairCounts& other) {
  candidates += other.candidates;
  for (std::size_t k = 0; k < kTermCount; ++k) refused[k] += other.refused[k];
  return *this;
}

std::unique_ptr<Engine> make(const Problem& problem) {
  return std::make_unique<TreeEngine>(problem);
}

}  // namespace psf::filter::engine
