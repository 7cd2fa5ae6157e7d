// The queries of a problem in packets of 16, and the tree over its sources. Every walk starts from
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filter/engine/kernel.h"
#include "filter/engine/tree.h"
#include "filter/problem.h"
#include "search/box_index.h"

namespace psf::filter::engine {

class Packets {
 public:
  // The number of queries that share a search, which is that of the records below a parent.
  static constexpr std::size_t kGrain = kWidth * kWidth;

  explicit Packets(const Problem& problem);

  // Whether the values of all queries and sources are small enough for the bounds.
  [[nodiscard]] bool is_moderate() const;

  // The queries' record numbers in a compact order.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  [[nodiscard]] Tree& tree() { return tree_; }
  [[nodiscard]] const Tree& tree() const { return tree_; }
  [[nodiscard]] const search::BoxIndex& index() const { return index_; }  // over the parents
  [[nodiscard]] bool is_source(std::uint32_t i) const {
    return all_sources_ || p_.roles.of[i] == Role::source;
  }

  // Calls visit(queries, nodes, packet) for each packet of the queries [begin, end) of order().
  // `begin` is a multiple of kGrain, and the range has at most kGrain queries. `nodes` are the
  // parents near the queries.
  template <class Visit>
  void each(std::size_t begin, std::size_t end, const Visit& visit) const {
    const std::span queries = order().subspan(begin, end - begin);
    std::vector<std::uint32_t> nodes;
    search_for(begin, queries, nodes);
    for (std::size_t first = 0; first < queries.size(); first += kWidth) {
      const std::span some = queries.subspan(first, std::min(kWidth, queries.size() - first));
      Own own;
      Packet packet;
      fill(some, (begin + first) / kWidth, own, packet);
      visit(some, std::span<const std::uint32_t>(nodes), packet);
    }
  }

 private:
  // Columns and bounds of a packet that is not a group of the tree.
  struct Own {
    alignas(64) float columns[kMaxColumns * kWidth];
    alignas(64) float low[kMaxColumns * kWidth];  // every kWidth-th value is used, in `high` too
    alignas(64) float high[kMaxColumns * kWidth];
  };

  void search_for(std::size_t begin, std::span<const std::uint32_t> queries,
                  std::vector<std::uint32_t>& nodes) const;
  [[nodiscard]] search::Box box_of(std::span<const std::uint32_t> queries) const;
  void fill(std::span<const std::uint32_t> queries, std::size_t number, Own& own,
            Packet& packet) const;

  const Problem& p_;
  std::vector<std::uint32_t> order_;
  Tree tree_;
  bool all_sources_;  // every query is a source: then packets are groups, and ranges are parents
  search::BoxIndex index_;
};

}  // namespace psf::filter::engine
