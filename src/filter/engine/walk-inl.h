// kLanes queries walk the tree: whole nodes by their bounds where these decide, records where not.
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

// chi and the terms as the queries of some lanes see them. Term k has the bit k of `open`, in the
// order of kTermNames; chi has the bit after them.
class Terms {
 public:
  static constexpr unsigned kChi = 1u << kTermCount;

  Terms(const ColumnPlan& plan, const WeightTerms& on, const Packet& packet, std::size_t lane)
      : plan_(plan), packet_(packet), lane_(lane) {
    bits_ = kChi;
    const auto take = [this](std::size_t k, bool is_on) { bits_ |= unsigned{is_on} << k; };
    take(0, on.normal.has_value());
    take(1, on.reflectance.has_value());
    take(2, on.visibility);
    take(3, on.hit_distance.has_value());
    take(4, on.plane.has_value());
    take(5, on.direction.has_value());
    take(6, on.material);
    normal_ = on.normal.value_or(0);
    reflectance_sq_ = on.reflectance.value_or(0) * on.reflectance.value_or(0);
    hit_distance_ = on.hit_distance.value_or(0);
    direction_ = on.direction.value_or(0);
  }

  [[nodiscard]] HWY_INLINE unsigned bits() const { return bits_; }
  // Lanes with a query whose ball holds anything.
  [[nodiscard]] HWY_INLINE M queries() const { return hn::Gt(r_sq(), hn::Zero(kD)); }

  // For which queries the pair (i, i) passes.
  [[nodiscard]] HWY_INLINE M self() const {
    M pass = queries();
    for (unsigned left = bits_; left != 0; left &= left - 1) {
      with(left & (~left + 1), [&](const auto& term, std::size_t c) {
        pass = hn::And(pass, term.pass(SourceALane{packet_.columns[c] + lane_}));
      });
    }
    return pass;
  }

  // Calls visit(term, its first column) with the term's vectors; k: its bit.
  template <class Visit>
  HWY_INLINE void with(unsigned bit, const Visit& visit) const {
    switch (bit) {
      case kChi:
        return visit(Chi{distance(0), r_sq()}, std::size_t{0});
      case 1u << 0:
        return visit(cosine(*plan_.normal, normal_), *plan_.normal);
      case 1u << 1:
        return visit(Reflectance{distance(*plan_.reflectance), hn::Set(kD, reflectance_sq_)},
                     *plan_.reflectance);
      case 1u << 2:
        return visit(equal(*plan_.visibility), *plan_.visibility);
      case 1u << 3:
        return visit(HitDistance{column(*plan_.hit_distance), hn::Set(kD, hit_distance_)},
                     *plan_.hit_distance);
      case 1u << 4:
        return visit(Plane{distance(0), column(*plan_.normal), column(*plan_.normal + 1),
                           column(*plan_.normal + 2), hn::Load(kD, packet_.plane_reach + lane_)},
                     std::size_t{0});
      case 1u << 5:
        return visit(cosine(*plan_.direction, direction_), *plan_.direction);
      default:
        return visit(equal(*plan_.material), *plan_.material);
    }
  }

 private:
  [[nodiscard]] HWY_INLINE V r_sq() const { return hn::Load(kD, packet_.r_sq + lane_); }
  [[nodiscard]] HWY_INLINE V column(std::size_t c) const {
    return hn::Load(kD, packet_.columns[c] + lane_);
  }
  [[nodiscard]] HWY_INLINE Distance distance(std::size_t c) const {
    return {column(c), column(c + 1), column(c + 2)};
  }
  [[nodiscard]] HWY_INLINE Cosine cosine(std::size_t c, float t) const {
    return {column(c), column(c + 1), column(c + 2), hn::Set(kD, t)};
  }
  [[nodiscard]] HWY_INLINE Equal equal(std::size_t c) const {
    return {hn::BitCast(kDI, column(c))};
  }

  const ColumnPlan& plan_;
  const Packet& packet_;
  std::size_t lane_;
  unsigned bits_;
  float normal_, reflectance_sq_, hit_distance_, direction_;
};

// The queries' box: which children of a node are within reach of any of them.
class Reach {
 public:
  Reach(const Packet& packet, std::size_t lane) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      if (!(packet.r_sq[lane + k] > 0)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const float v = packet.columns[c][lane + k];
        low_[c] = empty_ ? v : std::min(low_[c], v);
        high_[c] = empty_ ? v : std::max(high_[c], v);
      }
      r_sq_ = empty_ ? packet.r_sq[lane + k] : std::max(r_sq_, packet.r_sq[lane + k]);
      empty_ = false;
    }
  }
  [[nodiscard]] bool is_empty() const { return empty_; }

  // A bit a child of the family; not only those that have one.
  [[nodiscard]] HWY_INLINE std::uint32_t children(const Bounds& family) const {
    std::uint32_t bits = 0;
    for (std::size_t place = 0; place < kWidth; place += kLanes) {
      const V dx = gap(0, family, place), dy = gap(1, family, place), dz = gap(2, family, place);
      const V gap_sq = sum_of_products(dx, dx, dy, dy, dz, dz);
      bits |= bits_of(hn::Lt(gap_sq, hn::Set(kD, r_sq_))) << place;
    }
    return bits;
  }

 private:
  [[nodiscard]] HWY_INLINE V gap(std::size_t c, const Bounds& family, std::size_t place) const {
    const V low = hn::Load(kD, family.low + c * kWidth + place);
    const V high = hn::Load(kD, family.high + c * kWidth + place);
    const V below = hn::Sub(low, hn::Set(kD, high_[c])),
            above = hn::Sub(hn::Set(kD, low_[c]), high);
    return hn::Max(hn::Max(below, above), hn::Zero(kD));
  }

  bool empty_ = true;
  float low_[3], high_[3], r_sq_ = 0;
};

HWY_INLINE Bounds node_bounds(const Tree& tree, std::size_t level, std::size_t node) {
  const float* low = tree.bounds(level, node / kWidth) + node % kWidth;
  return {low, low + tree.plan().count * kWidth};
}

class AverageWalk {
 public:
  AverageWalk(const Tree& tree, const WeightTerms& on, Packet& packet, std::size_t lane)
      : tree_(tree),
        terms_(tree.plan(), on, packet, lane),
        reach_(packet, lane),
        sums_(packet, lane) {}

  HWY_INLINE void run(std::span<const std::uint32_t> nodes) {
    sums_.set_met_itself(terms_.self());
    if (reach_.is_empty()) return;
    for (const std::uint32_t node : nodes) parent(node);
  }

 private:
  struct Open {
    M lanes;         // queries for which the node is not decided
    unsigned terms;  // what is not known to pass for all of these
  };

  HWY_INLINE void parent(std::uint32_t node) {
    std::uint32_t children = reach_.children(node_bounds(tree_, 0, std::size_t{node} * kWidth));
    if (children == 0) return;
    Open open{terms_.queries(), terms_.bits()};
    if (!descend(1, node, open)) return;
    for (; children != 0; children &= children - 1) {
      const std::size_t child = node * kWidth + static_cast<unsigned>(std::countr_zero(children));
      Open below = open;
      if (child < tree_.nodes(0) && descend(0, child, below)) records(child, below);
    }
  }

  // Takes out the lanes that the bounds decide, adding the node's sum for those where all below
  // pass; false where no lane is left.
  HWY_INLINE bool descend(std::size_t level, std::size_t node, Open& open) {
    const Bounds bounds = node_bounds(tree_, level, node);
    M every = open.lanes;
    for (unsigned left = open.terms; left != 0;) {
      const unsigned bit = std::bit_floor(left);  // chi first: it decides most
      left ^= bit;
      Verdict verdict;
      terms_.with(bit,
                  [&](const auto& term, std::size_t c) { verdict = term.judge(bounds.column(c)); });
      open.lanes = hn::AndNot(verdict.none, open.lanes);
      if (hn::AllFalse(kD, open.lanes)) return false;
      if (hn::AllFalse(kD, hn::AndNot(verdict.every, open.lanes))) open.terms ^= bit;
      every = hn::And(every, verdict.every);
    }
    every = hn::And(every, open.lanes);
    if (hn::AllFalse(kD, every)) return true;
    const std::size_t below = level == 0 ? kWidth : kWidth * kWidth;
    sums_.add(every, tree_.sums(level, node / kWidth) + node % kWidth,
              std::min(below, tree_.size() - node * below));
    open.lanes = hn::AndNot(every, open.lanes);
    return !hn::AllFalse(kD, open.lanes);
  }

  HWY_INLINE void records(std::size_t group, const Open& open) {
    const std::size_t count = std::min(kWidth, tree_.size() - group * kWidth);
    const float* columns = tree_.group(group);
    // Each term in a loop of its own over the sources, the last one together with the sums.
    M pass[kWidth];
    for (M& mask : pass) mask = open.lanes;
    unsigned left = open.terms;
    for (; !std::has_single_bit(left); left &= left - 1) {
      terms_.with(left & (~left + 1), [&](const auto& term, std::size_t c) {
        const float* first = columns + c * kWidth;
        for (std::size_t k = 0; k < kWidth; ++k) {
          pass[k] = hn::And(pass[k], term.pass(OneSource{first + k}));
        }
      });
    }
    terms_.with(left, [&](const auto& term, std::size_t c) {
      const float* first = columns + c * kWidth;
      const auto mask = [&](std::size_t k) {
        return hn::And(pass[k], term.pass(OneSource{first + k}));
      };
      sums_.add(mask, tree_.values(group), count);
    });
  }

  const Tree& tree_;
  Terms terms_;
  Reach reach_;
  Sums sums_;
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
