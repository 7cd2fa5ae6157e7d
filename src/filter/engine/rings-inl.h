// A packet of queries walks the tree for several radii at once: every pair goes to its ring.
#if defined(PSF_FILTER_ENGINE_RINGS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_RINGS_INL_H
#undef PSF_FILTER_ENGINE_RINGS_INL_H
#else
#define PSF_FILTER_ENGINE_RINGS_INL_H
#endif

#include <algorithm>

#include "filter/engine/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

// The entry of the table for a value in each lane.
class RingLookup {
 public:
  explicit RingLookup(const RingTable& table)
      : data_(table.data()),
        first_(hn::Set(kDI, table.first_place())),
        last_(hn::Set(kDI, table.last_index())) {}

  // t: squared distances over f_i^2, none negative.
  [[nodiscard]] HWY_INLINE VI of(V t) const {
    const VI place = hn::ShiftRight<RingTable::kShift>(hn::BitCast(kDI, t));
    const VI index = hn::Min(hn::Max(hn::Sub(place, first_), hn::Zero(kDI)), last_);
    return hn::GatherIndex(kDI, data_, index);
  }

 private:
  const std::int32_t* data_;
  VI first_, last_;
};

// Four doubles: red, green, blue and a count.
struct Quadruple {
  using Tag = hn::CappedTag<double, 4>;
  static constexpr Tag kTag{};
  static constexpr std::size_t kStep = hn::MaxLanes(kTag);

  static HWY_INLINE void add(const double* value, double* sum) {
    for (std::size_t k = 0; k < 4; k += kStep) {
      hn::StoreU(hn::Add(hn::LoadU(kTag, sum + k), hn::LoadU(kTag, value + k)), kTag, sum + k);
    }
  }
};

class RingWalk {
 public:
  RingWalk(const Tree& tree, const WeightTerms& on, const RingTable& table, Packet& packet,
           RingPacket& rings)
      : tree_(tree),
        on_(on),
        packet_(packet),
        rings_(rings),
        count_(table.rings()),
        stride_((count_ + 1) * 4),
        lookup_(table),
        terms_(tree.plan(), on, packet, 0),
        judge_(tree, terms_, packet) {
    const auto [least, most] =
        std::minmax_element(rings.inverse_basis_sq, rings.inverse_basis_sq + kWidth);
    least_inverse_ = *least;
    greatest_inverse_ = *most;
    // `plane` has another ring for a pair than its distance has.
    compare_all_ = on.plane || std::any_of(rings.inverse_basis_sq, rings.inverse_basis_sq + kWidth,
                                           [](float v) { return v != v; });
  }

  HWY_INLINE void run(std::span<const std::uint32_t> parents) {
    for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
      Sums(packet_, lane).set_met_itself(Terms(tree_.plan(), on_, packet_, lane).self());
    }
    if (!judge_.is_reached()) return;
    each_family(parents, [this](std::size_t family, std::uint32_t asked)
                             HWY_ATTR { visit_parents(family, asked); });
  }

 private:
  // Of the nodes of a family: which have every pair in one ring, and in which.
  struct OneRing {
    std::uint32_t nodes = 0;
    alignas(64) std::int32_t ring[kWidth];
  };
  HWY_INLINE OneRing in_one_ring(const float* bounds, std::size_t columns) const {
    OneRing one;
    if (compare_all_) return one;
    const V least = hn::Set(kD, least_inverse_), greatest = hn::Set(kD, greatest_inverse_);
    for (std::size_t place = 0; place < kWidth; place += kLanes) {
      const Interval d_sq = Distance::between(judge_.queries(), {bounds, columns, place}, 0);
      const VI low = lookup_.of(hn::Mul(d_sq.low, least));
      const VI high = lookup_.of(hn::Mul(d_sq.high, greatest));
      const VI odd = hn::And(low, hn::Set(kDI, 1));  // so is kOpen
      const auto same = hn::And(hn::Eq(low, high), hn::Eq(odd, hn::Zero(kDI)));
      one.nodes |= bits_of(hn::RebindMask(kD, same)) << place;
      hn::Store(hn::ShiftRight<1>(low), kDI, one.ring + place);
    }
    return one;
  }

  HWY_INLINE void visit_parents(std::size_t family, std::uint32_t asked) {
    const float* bounds = tree_.bounds(kParents, family);
    const Balls balls(judge_.queries(), bounds, tree_.plan().count);
    std::uint32_t left = balls.touched & asked;
    if ((balls.inside & left) != 0) {
      const OneRing one = in_one_ring(bounds, tree_.plan().count);
      if ((one.nodes & left) != 0) {
        const Judged judged = judge_.nodes(kParents, family, left);
        const std::uint32_t whole = judged.closed & one.nodes;
        add_whole(kParents, family, whole, one);
        left = judged.touched & ~whole;
      }
    }
    for (; left != 0; left &= left - 1) visit_groups(family * kWidth + lowest_bit(left));
  }

  HWY_INLINE void visit_groups(std::size_t parent) {
    const Judged judged = judge_.nodes(kGroups, parent, judge_.groups_of(parent));
    if (judged.touched == 0) return;
    std::uint32_t whole = judged.whole();
    if (whole != 0) {
      const OneRing one = in_one_ring(tree_.bounds(kGroups, parent), tree_.plan().count);
      whole &= one.nodes;
      add_whole(kGroups, parent, whole, one);
    }
    for (std::uint32_t left = judged.touched & ~whole; left != 0; left &= left - 1) {
      const std::uint32_t place = lowest_bit(left);
      add_group(parent * kWidth + place, judged.open_at(place));
    }
  }

  // Of the given nodes, every source for every query.
  HWY_INLINE void add_whole(LevelName level, std::size_t family, std::uint32_t nodes,
                            const OneRing& one) {
    const double* sums = tree_.sums(level, family);
    for (; nodes != 0; nodes &= nodes - 1) {
      const std::uint32_t k = lowest_bit(nodes);
      const double value[4] = {sums[k], sums[kWidth + k], sums[2 * kWidth + k],
                               static_cast<double>(tree_.size_of(level, family * kWidth + k))};
      Quadruple::add(value, rings_.whole + 4 * one.ring[k]);
    }
  }

  // The records of a group, pair by pair.
  HWY_INLINE void add_group(std::size_t group, std::uint32_t open) {
    const float* columns = tree_.group(group);
    const double* values = tree_.values(group);
    const std::size_t count = tree_.size_of(kGroups, group);
    alignas(64) double value[kWidth][4];
    for (std::size_t k = 0; k < kWidth; ++k) {
      value[k][0] = values[k];
      value[k][1] = values[kWidth + k];
      value[k][2] = values[2 * kWidth + k];
      value[k][3] = 1;
    }
    for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
      const Terms terms(tree_.plan(), on_, packet_, lane);
      const Chi chi = terms.chi();
      const V inverse = hn::Load(kD, rings_.inverse_basis_sq + lane);
      M pass[kWidth];
      V d_sq[kWidth];
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
      // First where all go, so that the look-ups do not wait for each other. Pairs that do not
      // pass go to a ring behind the last, which nobody reads: faster than to ask.
      const VI beyond = hn::Set(kDI, static_cast<std::int32_t>(count_));
      const VI queries = hn::Iota(kDI, static_cast<std::int32_t>(lane));
      const VI radii = hn::Mul(queries, beyond);
      const VI sums = hn::Mul(queries, hn::Set(kDI, static_cast<std::int32_t>(stride_)));
      alignas(64) std::int32_t place_of[kWidth][kLanes];  // of the sums
      for (std::size_t k = 0; k < count; ++k) {
        const auto lanes = hn::RebindMask(kDI, pass[k]);
        if (hn::AllFalse(kDI, lanes)) continue;
        const VI entry = lookup_.of(hn::Mul(d_sq[k], inverse));
        VI ring = hn::ShiftRight<1>(entry);
        const auto is_odd = hn::Ne(hn::And(entry, hn::Set(kDI, 1)), hn::Zero(kDI));
        if (!hn::AllFalse(kDI, hn::And(lanes, is_odd))) {  // so is kOpen
          ring = hn::Max(ring, hn::Zero(kDI));
          const V r_sq = hn::GatherIndex(kD, rings_.r_sq, hn::Add(radii, ring));
          const auto next = hn::RebindMask(kDI, hn::Ge(d_sq[k], r_sq));
          ring = hn::Sub(ring, hn::VecFromMask(kDI, hn::And(is_odd, next)));
        }
        ring = hn::IfThenElse(lanes, ring, beyond);
        hn::Store(hn::Add(hn::ShiftLeft<2>(ring), sums), kDI, place_of[k]);
        const auto unknown = hn::And(lanes, hn::Lt(entry, hn::Zero(kDI)));
        if (compare_all_ || !hn::AllFalse(kDI, unknown)) {
          const M asked = compare_all_ ? pass[k] : hn::RebindMask(kD, unknown);
          compare_lanes(columns + k, lane, bits_of(asked), place_of[k]);
        }
      }
      for (std::size_t k = 0; k < count; ++k) {
        if (!hn::AllFalse(kD, pass[k])) add_pairs(place_of[k], value[k]);
      }
    }
  }

  HWY_INLINE void add_pairs(const std::int32_t* place_of, const double* value) {
    for (std::size_t q = 0; q < kLanes; ++q) {
      Quadruple::add(value, rings_.sums + static_cast<std::uint32_t>(place_of[q]));
    }
  }

  void compare_lanes(const float* source, std::size_t lane, std::uint32_t lanes,
                     std::int32_t* place_of) const {
    for (; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t q = lowest_bit(lanes);
      const std::size_t ring = compare(source, lane + q);
      place_of[q] = static_cast<std::int32_t>((lane + q) * stride_ + ring * 4);
    }
  }

  // The ring of a pair by comparing with the radii; the pair passes with the largest.
  std::size_t compare(const float* source, std::size_t q) const {
    const float* x = packet_.columns + q;
    const Vec3 x_i(x[0], x[kWidth], x[2 * kWidth]);
    const Vec3 x_j(source[0], source[kWidth], source[2 * kWidth]);
    const float d_sq = search::distance_sq(x_j, x_i);
    const float* r_sq = rings_.r_sq + q * count_;
    auto ring = static_cast<std::size_t>(std::upper_bound(r_sq, r_sq + count_, d_sq) - r_sq);
    if (on_.plane) {
      const float* n = x + *tree_.plan().normal * kWidth;
      const Vec3 n_i(n[0], n[kWidth], n[2 * kWidth]);
      const float* r = rings_.r + q * count_;
      while (!plane_term(x_i, n_i, x_j, *on_.plane, r[ring])) ++ring;
    }
    return ring;
  }

  const Tree& tree_;
  const WeightTerms& on_;
  Packet& packet_;
  RingPacket& rings_;
  std::size_t count_, stride_;  // rings; doubles a query
  RingLookup lookup_;
  Terms terms_;
  Judge judge_;
  float least_inverse_, greatest_inverse_;
  bool compare_all_;  // every pair with the radii, whatever the table says
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
