// Chi and every term of w_ij as vector code. `pass` tests pairs as weights.h does, one query per
// lane; `judge` decides by bounds for a packet and a family of nodes, one node per lane.
#if defined(PSF_FILTER_ENGINE_TERMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_TERMS_INL_H
#undef PSF_FILTER_ENGINE_TERMS_INL_H
#else
#define PSF_FILTER_ENGINE_TERMS_INL_H
#endif

#include "filter/engine/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

// What the bounds say of a term, one node per lane: that no pair of a query and a source below the
// node passes, or that every pair passes. Where neither is set, the pairs have to be tested.
struct Verdict {
  M none, every;
};

// Squared distance in three columns, for chi, `reflectance` and `gloss`. x, y, z are the queries'.
struct Distance {
  V x, y, z;

  template <class Source>
  [[nodiscard]] HWY_INLINE V to(const Source& source) const {
    const V dx = hn::Sub(x, source.column(0));
    const V dy = hn::Sub(y, source.column(1));
    const V dz = hn::Sub(z, source.column(2));
    return sum_of_products(dx, dx, dy, dy, dz, dz);
  }
  // For each node, an interval that holds the squared distance of every query to every source below
  // the node. `first`: number of the first of the three columns.
  static HWY_INLINE Interval between(const PacketBounds& queries, const FamilyBounds& nodes,
                                     std::size_t first) {
    V near[3], far[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const Interval d = difference(nodes.interval(first + c), queries.interval(first + c));
      near[c] = hn::Max(hn::Max(d.low, hn::Neg(d.high)), hn::Zero(kD));
      far[c] = hn::Max(d.high, hn::Neg(d.low));
    }
    return {sum_of_products(near[0], near[0], near[1], near[1], near[2], near[2]),
            sum_of_products(far[0], far[0], far[1], far[1], far[2], far[2])};
  }
};

struct Chi {
  Distance distance;
  V r_sq;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Lt(distance.to(source), r_sq);
  }
  static HWY_INLINE Verdict judge(const PacketBounds& queries, const FamilyBounds& nodes) {
    const Interval d_sq = Distance::between(queries, nodes, 0);
    return {hn::Ge(d_sq.low, hn::Set(kD, queries.greatest_r_sq)),
            hn::Lt(d_sq.high, hn::Set(kD, queries.least_r_sq))};
  }
};

struct Reflectance {
  std::size_t first;
  Distance distance;
  V t_sq;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Le(distance.to(source), t_sq);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const PacketBounds& queries,
                                         const FamilyBounds& nodes) const {
    const Interval d_sq = Distance::between(queries, nodes, first);
    return {hn::Gt(d_sq.low, t_sq), hn::Le(d_sq.high, t_sq)};
  }
};

// The terms `normal` and `direction`.
struct Cosine {
  std::size_t first;
  V x, y, z, t;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Ge(sum_of_products(x, source.column(0), y, source.column(1), z, source.column(2)),
                  t);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const PacketBounds& queries,
                                         const FamilyBounds& nodes) const {
    const auto along = [&](std::size_t c) {
      return product(queries.interval(first + c), nodes.interval(first + c));
    };
    const Interval cosine = sum(along(0), along(1), along(2));
    return {hn::Lt(cosine.high, t), hn::Ge(cosine.low, t)};
  }
};

// The terms `visibility` and `material`.
struct Equal {
  std::size_t first;
  VI bits;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::RebindMask(kD, hn::Eq(bits, hn::BitCast(kDI, source.column(0))));
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const PacketBounds& queries,
                                         const FamilyBounds& nodes) const {
    const Interval q = queries.interval(first), n = nodes.interval(first);
    const VI q_low = hn::BitCast(kDI, q.low), q_high = hn::BitCast(kDI, q.high);
    const VI n_low = hn::BitCast(kDI, n.low), n_high = hn::BitCast(kDI, n.high);
    const auto apart = hn::Or(hn::Gt(n_low, q_high), hn::Lt(n_high, q_low));
    const auto same = hn::And(hn::Eq(n_low, q_high), hn::Eq(n_high, q_low));
    return {hn::RebindMask(kD, apart), hn::RebindMask(kD, same)};
  }
};

struct HitDistance {
  std::size_t first;
  V h, t;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    const V other = source.column(0);
    const V longer = hn::IfThenElse(hn::Lt(h, other), other, h);
    const M close = hn::Le(hn::Abs(hn::Sub(h, other)), hn::Mul(t, longer));
    return hn::Or(hn::Eq(h, other), hn::And(close, hn::IsFinite(longer)));
  }
  // Every pair passes where the greatest difference is within t times the least that the longer
  // distance can be; none where the least difference is above t times the greatest it can be. The
  // difference of two misses (infinity) is NaN, for which no comparison holds.
  [[nodiscard]] HWY_INLINE Verdict judge(const PacketBounds& queries,
                                         const FamilyBounds& nodes) const {
    const Interval q = queries.interval(first), n = nodes.interval(first);
    const Interval d = difference(n, q);
    const V most = hn::Max(d.high, hn::Neg(d.low)), fewest = hn::Max(d.low, hn::Neg(d.high));
    const V longest = hn::Max(q.high, n.high);
    const M same = hn::And(hn::Eq(n.low, q.high), hn::Eq(n.high, q.low));
    const M close = hn::And(hn::Le(most, hn::Mul(t, hn::Max(q.low, n.low))), hn::IsFinite(longest));
    const M apart = hn::And(hn::Gt(fewest, hn::Mul(t, longest)), hn::Gt(fewest, hn::Zero(kD)));
    return {apart, hn::Or(same, close)};
  }
};

struct Plane {
  std::size_t normal;  // first column of the normal; the position's is 0
  Distance position;   // x_i of the queries
  V n_x, n_y, n_z, reach;

  // The distance of the source from the query's plane.
  template <class Source>
  [[nodiscard]] HWY_INLINE V off(const Source& source) const {
    return hn::Abs(sum_of_products(hn::Sub(source.column(0), position.x), n_x,
                                   hn::Sub(source.column(1), position.y), n_y,
                                   hn::Sub(source.column(2), position.z), n_z));
  }
  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Le(off(source), reach);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const PacketBounds& queries,
                                         const FamilyBounds& nodes) const {
    const auto along = [&](std::size_t c) {
      return product(difference(nodes.interval(c), queries.interval(c)),
                     queries.interval(normal + c));
    };
    const Interval off = sum(along(0), along(1), along(2));
    const V least = hn::Set(kD, queries.least_reach), most = hn::Set(kD, queries.greatest_reach);
    return {hn::Or(hn::Gt(off.low, most), hn::Lt(off.high, hn::Neg(most))),
            hn::And(hn::Le(hn::Abs(off.low), least), hn::Le(hn::Abs(off.high), least))};
  }
};

// The term `gloss`. Its columns are not adjacent, so `pass` takes a source that begins at column 0.
struct Gloss {
  std::size_t normal, direction, width;  // first column of each
  Distance n, omega;                     // n_i and omega_i of the queries
  V t, reach_sq;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Le(weighted(n.to(Source{source.at + normal * kWidth}),
                           omega.to(Source{source.at + direction * kWidth})),
                  reach_sq);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const PacketBounds& queries,
                                         const FamilyBounds& nodes) const {
    const Interval d_n = Distance::between(queries, nodes, normal);
    const Interval d_omega = Distance::between(queries, nodes, direction);
    const Interval w = queries.interval(width);
    return {hn::Gt(weighted(d_n.low, d_omega.low), square(hn::Mul(t, w.high))),
            hn::Le(weighted(d_n.high, d_omega.high), square(hn::Mul(t, w.low)))};
  }
  static HWY_INLINE V weighted(V n_sq, V omega_sq) {
    return hn::Add(n_sq, hn::Mul(hn::Set(kD, kDirectionWeight), omega_sq));
  }
  static HWY_INLINE V square(V reach) { return hn::Mul(reach, reach); }
};

// The terms that are on, with the values of the queries in kLanes lanes of a packet, from `lane`
// on.
class Terms {
 public:
  Terms(const ColumnPlan& plan, const WeightTerms& on, const Packet& packet, std::size_t lane)
      : plan_(plan), on_(on), packet_(packet), lane_(lane) {
    for (std::size_t k = 0; k < kTermCount; ++k) {
      const auto term = static_cast<Term>(k);
      if (on.on(term)) bits_ |= bit(term);
    }
  }

  [[nodiscard]] HWY_INLINE std::uint32_t bits() const { return bits_; }
  [[nodiscard]] HWY_INLINE Chi chi() const {
    return {distance(0), hn::Load(kD, packet_.r_sq + lane_)};
  }
  // The mask of the queries i for which the pair (i, i) passes chi and all terms.
  [[nodiscard]] HWY_INLINE M self() const {
    const auto own = [this](std::size_t c) {
      return SourceALane{packet_.columns + c * kWidth + lane_};
    };
    M pass = chi().pass(own(0));
    each(bits_, [&](std::size_t, const auto& term, std::size_t c) {
      pass = hn::And(pass, term.pass(own(c)));
    });
    return pass;
  }

  [[nodiscard]] HWY_INLINE Plane plane() const {
    const std::size_t n = *plan_.normal;
    const V reach = hn::Load(kD, packet_.plane_reach + lane_);
    return {n, distance(0), column(n), column(n + 1), column(n + 2), reach};
  }
  // Calls visit(k, term, c) for each term of `bits`, k its value; c is the column at which the
  // source begins that `pass` takes.
  template <class Visit>
  HWY_INLINE void each(std::uint32_t bits, const Visit& visit) const {
    const auto wants = [bits](Term term) { return (bits & bit(term)) != 0; };
    const auto give = [&visit](Term term, const auto& value, std::size_t c) {
      visit(static_cast<std::size_t>(term), value, c);
    };
    if (wants(Term::normal)) give(Term::normal, cosine(*plan_.normal, *on_.normal), *plan_.normal);
    if (wants(Term::reflectance)) {
      const std::size_t c = *plan_.reflectance;
      const float t = *on_.reflectance;
      give(Term::reflectance, Reflectance{c, distance(c), hn::Set(kD, t * t)}, c);
    }
    if (wants(Term::visibility)) {
      give(Term::visibility, equal(*plan_.visibility), *plan_.visibility);
    }
    if (wants(Term::hit_distance)) {
      const std::size_t c = *plan_.hit_distance;
      give(Term::hit_distance, HitDistance{c, column(c), hn::Set(kD, *on_.hit_distance)}, c);
    }
    if (wants(Term::plane)) give(Term::plane, plane(), 0);
    if (wants(Term::direction)) {
      give(Term::direction, cosine(*plan_.direction, *on_.direction), *plan_.direction);
    }
    if (wants(Term::material)) give(Term::material, equal(*plan_.material), *plan_.material);
    if (wants(Term::gloss)) give(Term::gloss, gloss(), 0);
  }

 private:
  [[nodiscard]] HWY_INLINE V column(std::size_t c) const {
    return hn::Load(kD, packet_.columns + c * kWidth + lane_);
  }
  [[nodiscard]] HWY_INLINE Distance distance(std::size_t c) const {
    return {column(c), column(c + 1), column(c + 2)};
  }
  [[nodiscard]] HWY_INLINE Cosine cosine(std::size_t c, float t) const {
    return {c, column(c), column(c + 1), column(c + 2), hn::Set(kD, t)};
  }
  [[nodiscard]] HWY_INLINE Gloss gloss() const {
    const std::size_t n = *plan_.normal, omega = *plan_.direction, w = *plan_.lobe_width;
    const V t = hn::Set(kD, *on_.gloss);
    return {n, omega, w, distance(n), distance(omega), t, Gloss::square(hn::Mul(t, column(w)))};
  }
  [[nodiscard]] HWY_INLINE Equal equal(std::size_t c) const {
    return {c, hn::BitCast(kDI, column(c))};
  }

  const ColumnPlan& plan_;
  const WeightTerms& on_;
  const Packet& packet_;
  std::size_t lane_;
  std::uint32_t bits_ = 0;
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
