// A packet of queries walks the tree: nodes that bounds decide are added or skipped as a whole, and
// the rest is tested pair by pair.
#if defined(PSF_FILTER_ENGINE_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_WALK_INL_H
#undef PSF_FILTER_ENGINE_WALK_INL_H
#else
#define PSF_FILTER_ENGINE_WALK_INL_H
#endif

#include <algorithm>
#include <bit>

#include "filter/engine/sums-inl.h"
#include "filter/engine/terms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

HWY_INLINE std::uint32_t lowest_bit(std::uint32_t bits) {
  return static_cast<std::uint32_t>(std::countr_zero(bits));
}

// Two sets of nodes of a family, one bit per node: those that may have sources in the ball of some
// query (touched), and those whose sources are all in the balls of all queries (inside).
struct Balls {
  std::uint32_t touched = 0, inside = 0;

  HWY_INLINE Balls(const PacketBounds& queries, const float* bounds, std::size_t columns) {
    for (std::size_t place = 0; place < kWidth; place += kLanes) {
      const Verdict verdict = Chi::judge(queries, {bounds, columns, place});
      touched |= bits_of(hn::Not(verdict.none)) << place;
      inside |= bits_of(verdict.every) << place;
    }
  }
};

// What the bounds decide for the nodes of a family, one bit per node.
struct Judged {
  std::uint32_t touched = 0;            // nodes with a pair that may pass; others have none
  std::uint32_t inside = 0;             // touched nodes of which every pair passes chi
  std::uint32_t closed = 0;             // touched nodes of which every pair passes every term
  std::uint32_t open[kTermCount] = {};  // by term: nodes of which some pair may not pass it

  // The terms that are open at a node, one bit per term.
  [[nodiscard]] HWY_INLINE std::uint32_t open_at(std::uint32_t node) const {
    std::uint32_t terms = 0;
    for (std::size_t k = 0; k < kTermCount; ++k) terms |= (open[k] >> node & 1) << k;
    return terms;
  }
  [[nodiscard]] HWY_INLINE std::uint32_t whole() const { return inside & closed; }
};

class Judge {
 public:
  Judge(const Tree& tree, const Terms& terms, const Packet& packet)
      : tree_(tree), terms_(terms), queries_(packet) {}

  [[nodiscard]] const PacketBounds& queries() const { return queries_; }
  [[nodiscard]] HWY_INLINE bool is_reached() const { return queries_.greatest_r_sq > 0; }

  // The bits of the groups of a parent that exist.
  [[nodiscard]] HWY_INLINE std::uint32_t groups_of(std::size_t parent) const {
    const std::size_t count = std::min(kWidth, tree_.nodes(kGroups) - parent * kWidth);
    return (2u << (count - 1)) - 1;
  }

  // The bits of the groups of a parent that have 16 records; only the tree's last group may have
  // fewer.
  [[nodiscard]] HWY_INLINE std::uint32_t full_groups_of(std::size_t parent) const {
    const std::size_t count = std::min(kWidth, tree_.size() / kWidth - parent * kWidth);
    return (1u << count) - 1;
  }

  // Judges the nodes `asked`, a bit each, of a family of groups or of parents.
  [[nodiscard]] HWY_INLINE Judged nodes(LevelName level, std::size_t family,
                                        std::uint32_t asked) const {
    const float* bounds = tree_.bounds(level, family);
    const std::size_t columns = tree_.plan().count;
    const Balls balls(queries_, bounds, columns);
    Judged judged;
    judged.touched = balls.touched & asked;
    if (judged.touched == 0) return judged;
    std::uint32_t every = ~0u;
    terms_.each(terms_.bits(), [&](std::size_t k, const auto& term, std::size_t) {
      std::uint32_t none_pass = 0, all_pass = 0;
      for (std::size_t place = 0; place < kWidth; place += kLanes) {
        const Verdict verdict = term.judge(queries_, {bounds, columns, place});
        none_pass |= bits_of(verdict.none) << place;
        all_pass |= bits_of(verdict.every) << place;
      }
      judged.touched &= ~none_pass;
      judged.open[k] = ~all_pass;
      every &= all_pass;
    });
    judged.inside = balls.inside & judged.touched;
    judged.closed = every & judged.touched;
    return judged;
  }

 private:
  const Tree& tree_;
  const Terms& terms_;
  PacketBounds queries_;
};

// Sets packet.met_itself.
HWY_INLINE void set_met_itself(const ColumnPlan& plan, const WeightTerms& on, Packet& packet) {
  for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
    const M self = Terms(plan, on, packet, lane).self();
    hn::Store(hn::VecFromMask(kDI, hn::RebindMask(kDI, self)), kDI, packet.met_itself + lane);
  }
}

// Calls visit(family, bits) for each family that has any of the given parents; `bits` are its nodes
// among them.
template <class Visit>
HWY_INLINE void each_family(std::span<const std::uint32_t> parents, const Visit& visit) {
  for (std::size_t k = 0; k < parents.size();) {
    const std::size_t family = parents[k] / kWidth;
    std::uint32_t asked = 0;
    for (; k < parents.size() && parents[k] / kWidth == family; ++k) {
      asked |= 1u << parents[k] % kWidth;
    }
    visit(family, asked);
  }
}

// Gives `sink` the sources that a packet averages: nodes of which every source is averaged by every
// query, and single sources with the queries that average them. A sink has
//
//   add_nodes(level, family, bits, count)  the nodes of a family whose bits are set; `count`: the
//                                          number of sources below them
//   add_sources(lane, most, walk)          calls walk(add), which calls add(lanes, source) at most
//                                          `most` times: the queries, from `lane` on, of a source
//   group(g)                               the first source of group g; others are at group(g) + k
template <class Sink>
class SourceWalk {
 public:
  SourceWalk(const Tree& tree, const WeightTerms& on, Packet& packet, Sink& sink)
      : tree_(tree),
        on_(on),
        packet_(packet),
        sink_(sink),
        terms_(tree.plan(), on, packet, 0),
        judge_(tree, terms_, packet) {}

  HWY_INLINE void run(std::span<const std::uint32_t> parents) {
    set_met_itself(tree_.plan(), on_, packet_);
    if (!judge_.is_reached()) return;
    each_family(parents, [this](std::size_t family, std::uint32_t asked)
                             HWY_ATTR { visit_parents(family, asked); });
  }

 private:
  static constexpr std::size_t kQuad = kRecordsBelow[kQuads];
  static constexpr std::size_t kQuadsInGroup = kWidth / kQuad;

  // Judges the terms only where a parent is inside all balls and may pass as a whole; otherwise
  // they are judged at its groups.
  HWY_INLINE void visit_parents(std::size_t family, std::uint32_t asked) {
    const Balls balls(judge_.queries(), tree_.bounds(kParents, family), tree_.plan().count);
    std::uint32_t left = balls.touched & asked;
    if ((balls.inside & left) != 0) {
      const Judged judged = judge_.nodes(kParents, family, left);
      add_whole(kParents, family, judged.whole());
      left = judged.touched & ~judged.whole();
    }
    for (; left != 0; left &= left - 1) visit_groups(family * kWidth + lowest_bit(left));
  }

  HWY_INLINE void visit_groups(std::size_t parent) {
    const Judged judged = judge_.nodes(kGroups, parent, judge_.groups_of(parent));
    if (judged.touched == 0) return;
    const std::uint32_t whole = judged.whole();
    add_whole(kGroups, parent, whole);
    const std::uint32_t by_quads = judged.closed & ~whole & judge_.full_groups_of(parent);
    if (by_quads != 0) {
      choose_quads(parent, by_quads);
      for (std::size_t lane = 0; lane < kWidth; lane += kLanes) add_quads(lane);
    }
    for (std::uint32_t left = judged.touched & ~whole & ~by_quads; left != 0; left &= left - 1) {
      const std::uint32_t place = lowest_bit(left);
      for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
        add_group(parent * kWidth + place, judged.open_at(place), lane);
      }
    }
  }

  // Adds every source below the given nodes for every query.
  HWY_INLINE void add_whole(LevelName level, std::size_t family, std::uint32_t nodes) {
    if (nodes == 0) return;
    const std::size_t last = family * kWidth + static_cast<std::size_t>(std::bit_width(nodes)) - 1;
    const std::size_t before_last = static_cast<std::size_t>(std::popcount(nodes)) - 1;
    sink_.add_nodes(level, family, nodes,
                    before_last * kRecordsBelow[level] + tree_.size_of(level, last));
  }

  // For groups of which only chi is open: adds the quads that are inside all balls for every query,
  // and lists in quads_ those that are neither inside nor outside.
  HWY_INLINE void choose_quads(std::size_t parent, std::uint32_t groups) {
    quad_count_ = 0;
    for (std::size_t quarter = 0; quarter < kQuadsInGroup; ++quarter, groups >>= kQuadsInGroup) {
      const std::uint32_t wanted = quads_of(groups & 0xFu);
      if (wanted == 0) continue;
      const std::size_t family = parent * kQuadsInGroup + quarter;
      const Balls balls(judge_.queries(), tree_.bounds(kQuads, family), 3);
      const std::uint32_t inside = balls.inside & wanted;
      if (inside != 0) {
        sink_.add_nodes(kQuads, family, inside,
                        static_cast<std::size_t>(std::popcount(inside)) * kQuad);
      }
      quad_count_ += list(balls.touched & ~balls.inside & wanted,
                          static_cast<std::int32_t>(family * kWidth), quads_ + quad_count_);
    }
  }

  // The bits of the quads of four groups: four bits for each group.
  static HWY_INLINE std::uint32_t quads_of(std::uint32_t groups) {
    const std::uint32_t spread =
        (groups & 1) | (groups & 2) << 3 | (groups & 4) << 6 | (groups & 8) << 9;
    return spread * 0xFu;
  }

  HWY_INLINE void add_quads(std::size_t lane) {
    const Chi chi = Terms(tree_.plan(), on_, packet_, lane).chi();
    sink_.add_sources(lane, quad_count_ * kQuad, [&](auto&& add) {
      for (std::size_t q = 0; q < quad_count_; ++q) {
        const std::size_t group = static_cast<std::size_t>(quads_[q]) / kQuadsInGroup;
        const std::size_t first = static_cast<std::size_t>(quads_[q]) % kQuadsInGroup * kQuad;
        const float* columns = tree_.group(group) + first;
        const auto source = sink_.group(group) + first;
        for (std::size_t k = 0; k < kQuad; ++k) {
          add(chi.pass(OneSource{columns + k}), source + k);
        }
      }
    });
  }

  // Tests the records of a group, each term in a loop of its own, and adds those that pass.
  HWY_INLINE void add_group(std::size_t group, std::uint32_t open, std::size_t lane) {
    const Terms terms(tree_.plan(), on_, packet_, lane);
    const float* columns = tree_.group(group);
    const auto first_source = sink_.group(group);
    const std::size_t count = tree_.size_of(kGroups, group);
    const Chi chi = terms.chi();
    M pass[kWidth];
    for (std::size_t k = 0; k < kWidth; ++k) pass[k] = chi.pass(OneSource{columns + k});
    terms.each(open, [&](std::size_t, const auto& term, std::size_t c) {
      const float* first = columns + c * kWidth;
      for (std::size_t k = 0; k < kWidth; ++k) {
        pass[k] = hn::And(pass[k], term.pass(OneSource{first + k}));
      }
    });
    sink_.add_sources(lane, count, [&](auto&& add) {
      for (std::size_t k = 0; k < count; ++k) add(pass[k], first_source + k);
    });
  }

  const Tree& tree_;
  const WeightTerms& on_;
  Packet& packet_;
  Sink& sink_;
  Terms terms_;
  Judge judge_;
  // The listed quads of the parent at hand. list() stores whole vectors, so there is room for one
  // more.
  std::int32_t quads_[(kQuadsInGroup + 1) * kWidth];
  std::size_t quad_count_ = 0;
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
