// A packet of queries walks the tree for several radii at once: every pair is added to its ring.
#if defined(PSF_FILTER_ENGINE_RINGS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_RINGS_INL_H
#undef PSF_FILTER_ENGINE_RINGS_INL_H
#else
#define PSF_FILTER_ENGINE_RINGS_INL_H
#endif

#include <algorithm>

#include "filter/engine/means-inl.h"
#include "filter/engine/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

class RingWalk {
 public:
  RingWalk(const Tree& tree, const TreeSums& sums, const WeightTerms& on, Packet& packet,
           const RingPacket& rings)
      : tree_(tree),
        sums_(sums),
        on_(on),
        packet_(packet),
        rings_(rings),
        terms_(tree.plan(), on, packet, 0),
        judge_(tree, terms_, packet) {}

  HWY_INLINE void run(std::span<const std::uint32_t> parents) {
    set_met_itself(tree_.plan(), on_, packet_);
    if (!judge_.is_reached()) return;
    each_family(parents, [this](std::size_t family, std::uint32_t asked)
                             HWY_ATTR { visit_parents(family, asked); });
  }

 private:
  // The range of rings, [first, last], in which the distances of all pairs below a node lie.
  struct Window {
    std::size_t first, last;
  };
  // The windows of the nodes of a family.
  class Windows {
   public:
    HWY_INLINE Windows(const RingWalk& walk, LevelName level, std::size_t family) : walk_(walk) {
      const float* bounds = walk.tree_.bounds(level, family);
      for (std::size_t place = 0; place < kWidth; place += kLanes) {
        const Interval d_sq =
            Distance::between(walk.judge_.queries(), {bounds, walk.tree_.plan().count, place}, 0);
        hn::Store(d_sq.low, kD, low_ + place);
        hn::Store(d_sq.high, kD, high_ + place);
      }
    }
    [[nodiscard]] HWY_INLINE Window of(std::size_t node) const {
      return {rings_before(walk_.rings_.greatest_r_sq, low_[node]),
              rings_before(walk_.rings_.least_r_sq, high_[node])};
    }

   private:
    [[nodiscard]] HWY_INLINE std::size_t rings_before(const float* r_sq, float d_sq) const {
      std::size_t count = 0;
      for (std::size_t k = 0; k < walk_.rings_.count; k += kLanes) {
        count += hn::CountTrue(kD, hn::Ge(hn::Set(kD, d_sq), hn::Load(kD, r_sq + k)));
      }
      return std::min(count, walk_.rings_.count - 1);
    }

    const RingWalk& walk_;
    alignas(64) float low_[kWidth], high_[kWidth];  // squared distances
  };

  HWY_INLINE void visit_parents(std::size_t family, std::uint32_t asked) {
    const Balls balls(judge_.queries(), tree_.bounds(kParents, family), tree_.plan().count);
    std::uint32_t left = balls.touched & asked;
    if ((balls.inside & left) != 0) {
      const Judged judged = judge_.nodes(kParents, family, left);
      left = judged.touched & ~add_whole(kParents, family, judged.whole());
    }
    for (; left != 0; left &= left - 1) visit_groups(family * kWidth + lowest_bit(left));
  }

  HWY_INLINE void visit_groups(std::size_t parent) {
    const Judged judged = judge_.nodes(kGroups, parent, judge_.groups_of(parent));
    if (judged.touched == 0) return;
    const Windows windows(*this, kGroups, parent);
    for (std::uint32_t left = judged.touched; left != 0; left &= left - 1) {
      const std::uint32_t place = lowest_bit(left);
      const Window window = windows.of(place);
      const bool whole = (judged.whole() >> place & 1) != 0;
      if (whole && is_one_ring(window)) {
        add_node(kGroups, parent, place, window.first);
      } else {
        add_group(parent * kWidth + place, judged.open_at(place), window);
      }
    }
  }

  // Whether all pairs below a node are in the same ring. Never with `plane`, which may put a pair
  // into a later ring than its distance does.
  [[nodiscard]] HWY_INLINE bool is_one_ring(const Window& window) const {
    return !on_.plane && window.first == window.last;
  }

  // All pairs of `nodes` pass. Adds the nodes whose pairs are all in the same ring, and returns the
  // bits of these nodes.
  HWY_INLINE std::uint32_t add_whole(LevelName level, std::size_t family, std::uint32_t nodes) {
    if (nodes == 0) return 0;
    std::uint32_t added = 0;
    const Windows windows(*this, level, family);
    for (; nodes != 0; nodes &= nodes - 1) {
      const std::uint32_t place = lowest_bit(nodes);
      const Window window = windows.of(place);
      if (!is_one_ring(window)) continue;
      add_node(level, family, place, window.first);
      added |= 1u << place;
    }
    return added;
  }

  // Adds every source below a node to `ring` of every query.
  HWY_INLINE void add_node(LevelName level, std::size_t family, std::size_t place,
                           std::size_t ring) {
    const double* sums = sums_.below(level, family) + place;
    alignas(32) const double value[4] = {
        sums[0], sums[kWidth], sums[2 * kWidth],
        static_cast<double>(tree_.size_of(level, family * kWidth + place))};
    double* sum = rings_.whole + 4 * ring;
    (Quadruple::load(sum) + Quadruple::load(value)).store(sum);
  }

  // Tests the records of a group pair by pair, and adds those that pass to their rings.
  HWY_INLINE void add_group(std::size_t group, std::uint32_t open, const Window& window) {
    const double* values = sums_.values(group);
    for (std::size_t k = 0; k < kWidth; ++k) {
      value_[k][0] = values[k];
      value_[k][1] = values[kWidth + k];
      value_[k][2] = values[2 * kWidth + k];
      value_[k][3] = 1;
    }
    for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
      const Pairs pairs(*this, group, open, lane);
      std::int32_t source[kWidth + kLanes];
      const std::size_t n = list(pairs.met, 0, source);
      // First finds all places and then adds, so that additions do not wait.
      for (std::size_t k = n; k % kAtOnce != 0; ++k) source[k] = source[0];
      for (std::size_t k = 0; k < n; k += kAtOnce) {
        find_places(pairs, source + k, window, lane, place_of_ + k);
      }
      for (std::size_t k = 0; k < n; ++k) add_pairs(place_of_[k], value_[source[k]], rings_.sums);
    }
  }

  // The pairs of the sources of a group with the queries in some lanes of a packet.
  struct Pairs {
    Terms terms;
    const float* columns;
    M pass[kWidth];
    V d_sq[kWidth];
    std::uint32_t met = 0;  // bits of the sources that pass for at least one query

    HWY_INLINE Pairs(const RingWalk& walk, std::size_t group, std::uint32_t open, std::size_t lane)
        : terms(walk.tree_.plan(), walk.on_, walk.packet_, lane), columns(walk.tree_.group(group)) {
      const Chi chi = terms.chi();
      for (std::size_t k = 0; k < kWidth; ++k) {
        d_sq[k] = chi.distance.to(OneSource{columns + k});
        pass[k] = hn::Lt(d_sq[k], chi.r_sq);
      }
      terms.each(open, [&](std::size_t, const auto& term, std::size_t c) {
        const float* first = columns + c * kWidth;
        for (std::size_t k = 0; k < kWidth; ++k) {
          pass[k] = hn::And(pass[k], term.pass(OneSource{first + k}));
        }
      });
      const std::size_t count = walk.tree_.size_of(kGroups, group);
      for (std::size_t k = 0; k < count; ++k) {
        met |= static_cast<std::uint32_t>(!hn::AllFalse(kD, pass[k])) << k;
      }
    }
  };

  // Finds the places in RingPacket::sums to which kAtOnce sources are added. Pairs that do not pass
  // go to the ring behind the last, which nobody reads: that is faster than to branch.
  HWY_INLINE void find_places(const Pairs& pairs, const std::int32_t* source, const Window& window,
                              std::size_t lane, std::int32_t (*place_of)[kLanes]) const {
    V d_sq[kAtOnce];
    VI ring[kAtOnce];
    for (std::size_t k = 0; k < kAtOnce; ++k) {
      d_sq[k] = pairs.d_sq[source[k]];
      ring[k] = hn::Set(kDI, static_cast<std::int32_t>(window.first));
    }
    count_rings(rings_.r_sq + lane, window.first, window.last, ring,
                [&](std::size_t k, V r_sq) HWY_ATTR { return hn::Ge(d_sq[k], r_sq); });
    if (on_.plane) {
      const Plane plane = pairs.terms.plane();
      V off[kAtOnce];
      VI other[kAtOnce];
      for (std::size_t k = 0; k < kAtOnce; ++k) {
        off[k] = plane.off(OneSource{pairs.columns + source[k]});
        other[k] = hn::Zero(kDI);
      }
      count_rings(rings_.plane_reach + lane, 0, rings_.count - 1, other,
                  [&](std::size_t k, V reach) HWY_ATTR { return hn::Gt(off[k], reach); });
      for (std::size_t k = 0; k < kAtOnce; ++k) ring[k] = hn::Max(ring[k], other[k]);
    }
    const VI beyond = hn::Set(kDI, static_cast<std::int32_t>(rings_.count));
    static_assert(4 * kWidth == 1 << 6);
    const VI query = hn::ShiftLeft<2>(hn::Iota(kDI, static_cast<std::int32_t>(lane)));
    for (std::size_t k = 0; k < kAtOnce; ++k) {
      const auto pass = hn::RebindMask(kDI, pairs.pass[source[k]]);
      const VI to = hn::ShiftLeft<6>(hn::IfThenElse(pass, ring[k], beyond));
      hn::Store(hn::Add(to, query), kDI, place_of[k]);
    }
  }

  // Adds to each ring[k] the number of rings in [first, last) whose limit source k is beyond.
  template <class IsBeyond>
  static HWY_INLINE void count_rings(const float* limits, std::size_t first, std::size_t last,
                                     VI* ring, const IsBeyond& is_beyond) {
    for (std::size_t b = first; b < last; ++b) {
      const V limit = hn::Load(kD, limits + b * kWidth);
      for (std::size_t k = 0; k < kAtOnce; ++k) {
        ring[k] = add_one_where(is_beyond(k, limit), ring[k]);
      }
    }
  }

  static HWY_INLINE void add_pairs(const std::int32_t* place_of, const double* value,
                                   double* sums) {
    const Quadruple added = Quadruple::load(value);
    for (std::size_t q = 0; q < kLanes; ++q) {
      double* sum = sums + static_cast<std::uint32_t>(place_of[q]);
      (Quadruple::load(sum) + added).store(sum);
    }
  }

  static constexpr std::size_t kAtOnce = 4;  // number of sources that share a loop over rings

  const Tree& tree_;
  const TreeSums& sums_;
  const WeightTerms& on_;
  Packet& packet_;
  const RingPacket& rings_;
  Terms terms_;
  Judge judge_;
  // For the sources of the group at hand: red, green, blue and 1, and their places in the sums.
  alignas(64) double value_[kWidth][4];
  alignas(64) std::int32_t place_of_[kWidth + kAtOnce][kLanes];
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
