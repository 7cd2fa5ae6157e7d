// Every term of w_ij and chi in vectors: for a pair as weights.h has them, and for a node by its
// bounds. A query a lane.
#if defined(PSF_FILTER_ENGINE_TERMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_TERMS_INL_H
#undef PSF_FILTER_ENGINE_TERMS_INL_H
#else
#define PSF_FILTER_ENGINE_TERMS_INL_H
#endif

#include <hwy/highway.h>

#include "filter/engine/kernel.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kWidth>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr D kD;
constexpr DI kDI;
constexpr std::size_t kLanes = hn::MaxLanes(kD);

// What the bounds of a node say of a term, lane by lane: no source below passes, every one does.
struct Verdict {
  M none, every;
};

HWY_INLINE V broadcast(const float* value) {
  return hn::Set(kD, *value);
}
HWY_INLINE hn::Vec<DI> broadcast_bits(const float* value) {
  return hn::BitCast(kDI, broadcast(value));
}
// A source's columns, the same for every lane.
struct OneSource {
  const float* at;
  [[nodiscard]] HWY_INLINE V column(std::size_t c) const { return broadcast(at + c * kWidth); }
};
// A source a lane.
struct SourceALane {
  const float* at;
  [[nodiscard]] HWY_INLINE V column(std::size_t c) const { return hn::Load(kD, at + c * kWidth); }
};

HWY_INLINE V sum_of_products(V ax, V bx, V ay, V by, V az, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

// Least and greatest values of one column at nodes, `row` floats apart.
struct Bounds {
  const float* low;
  const float* high;
  [[nodiscard]] HWY_INLINE Bounds column(std::size_t c) const {
    return {low + c * kWidth, high + c * kWidth};
  }
};

// Squared distance of the queries' values to a source's, in three columns: chi and `reflectance`.
struct Distance {
  V x, y, z;

  template <class Source>
  [[nodiscard]] HWY_INLINE V to(const Source& source) const {
    const V dx = hn::Sub(x, source.column(0));
    const V dy = hn::Sub(y, source.column(1));
    const V dz = hn::Sub(z, source.column(2));
    return sum_of_products(dx, dx, dy, dy, dz, dz);
  }
  // The least and the greatest of a node.
  HWY_INLINE void range(const Bounds& node, V& nearest, V& farthest) const {
    V near_x, near_y, near_z, far_x, far_y, far_z;
    axis(x, node, near_x, far_x);
    axis(y, node.column(1), near_y, far_y);
    axis(z, node.column(2), near_z, far_z);
    nearest = sum_of_products(near_x, near_x, near_y, near_y, near_z, near_z);
    farthest = sum_of_products(far_x, far_x, far_y, far_y, far_z, far_z);
  }

 private:
  static HWY_INLINE void axis(V q, const Bounds& node, V& nearest, V& farthest) {
    const V above_low = hn::Sub(q, broadcast(node.low));
    const V above_high = hn::Sub(q, broadcast(node.high));
    nearest = hn::Max(hn::Max(above_high, hn::Neg(above_low)), hn::Zero(kD));
    farthest = hn::Max(hn::Abs(above_low), hn::Abs(above_high));
  }
};

struct Chi {
  Distance distance;
  V r_sq;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Lt(distance.to(source), r_sq);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const Bounds& node) const {
    V nearest, farthest;
    distance.range(node, nearest, farthest);
    return {hn::Ge(nearest, r_sq), hn::Lt(farthest, r_sq)};
  }
};

struct Reflectance {
  Distance distance;
  V t_sq;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Le(distance.to(source), t_sq);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const Bounds& node) const {
    V nearest, farthest;
    distance.range(node, nearest, farthest);
    return {hn::Gt(nearest, t_sq), hn::Le(farthest, t_sq)};
  }
};

// `normal` and `direction`.
struct Cosine {
  V x, y, z, t;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::Ge(sum_of_products(x, source.column(0), y, source.column(1), z, source.column(2)),
                  t);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const Bounds& node) const {
    V low_x, low_y, low_z, high_x, high_y, high_z;
    axis(x, node, low_x, high_x);
    axis(y, node.column(1), low_y, high_y);
    axis(z, node.column(2), low_z, high_z);
    const V least = hn::Add(hn::Add(low_x, low_y), low_z);
    const V greatest = hn::Add(hn::Add(high_x, high_y), high_z);
    return {hn::Lt(greatest, t), hn::Ge(least, t)};
  }

 private:
  static HWY_INLINE void axis(V q, const Bounds& node, V& least, V& greatest) {
    const V a = hn::Mul(q, broadcast(node.low)), b = hn::Mul(q, broadcast(node.high));
    least = hn::Min(a, b);
    greatest = hn::Max(a, b);
  }
};

// `visibility` and `material`.
struct Equal {
  hn::Vec<DI> bits;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    return hn::RebindMask(kD, hn::Eq(bits, hn::BitCast(kDI, source.column(0))));
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const Bounds& node) const {
    const auto low = broadcast_bits(node.low), high = broadcast_bits(node.high);
    const auto outside = hn::Or(hn::Lt(bits, low), hn::Gt(bits, high));
    const auto only = hn::And(hn::Eq(bits, low), hn::Eq(bits, high));
    return {hn::RebindMask(kD, outside), hn::RebindMask(kD, only)};
  }
};

struct HitDistance {
  V h, t;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    const V other = source.column(0);
    const V longer = hn::IfThenElse(hn::Lt(h, other), other, h);
    const M close = hn::Le(hn::Abs(hn::Sub(h, other)), hn::Mul(t, longer));
    return hn::Or(hn::Eq(h, other), hn::And(close, hn::IsFinite(longer)));
  }
  // By the greatest difference and the least of the longer ones, and the other way round.
  [[nodiscard]] HWY_INLINE Verdict judge(const Bounds& node) const {
    const V low = broadcast(node.low), high = broadcast(node.high);
    const V above_low = hn::Sub(h, low), above_high = hn::Sub(h, high);
    const V most = hn::Max(hn::Abs(above_low), hn::Abs(above_high));
    const V fewest = hn::Max(above_high, hn::Neg(above_low));
    const V longest = hn::Max(h, high);
    const M only = hn::And(hn::Eq(h, low), hn::Eq(h, high));
    const M close = hn::And(hn::Le(most, hn::Mul(t, hn::Max(h, low))), hn::IsFinite(longest));
    const M apart = hn::And(hn::Gt(fewest, hn::Mul(t, longest)), hn::Gt(fewest, hn::Zero(kD)));
    return {apart, hn::Or(only, close)};
  }
};

struct Plane {
  Distance position;  // of the query
  V n_x, n_y, n_z, reach;

  template <class Source>
  [[nodiscard]] HWY_INLINE M pass(const Source& source) const {
    const V off = sum_of_products(hn::Sub(source.column(0), position.x), n_x,
                                  hn::Sub(source.column(1), position.y), n_y,
                                  hn::Sub(source.column(2), position.z), n_z);
    return hn::Le(hn::Abs(off), reach);
  }
  [[nodiscard]] HWY_INLINE Verdict judge(const Bounds& node) const {
    V low_x, low_y, low_z, high_x, high_y, high_z;
    axis(position.x, n_x, node, low_x, high_x);
    axis(position.y, n_y, node.column(1), low_y, high_y);
    axis(position.z, n_z, node.column(2), low_z, high_z);
    const V least = hn::Add(hn::Add(low_x, low_y), low_z);
    const V greatest = hn::Add(hn::Add(high_x, high_y), high_z);
    const M every = hn::And(hn::Le(hn::Abs(least), reach), hn::Le(hn::Abs(greatest), reach));
    const M none = hn::Or(hn::Gt(least, reach), hn::Lt(greatest, hn::Neg(reach)));
    return {none, every};
  }

 private:
  static HWY_INLINE void axis(V q, V n, const Bounds& node, V& least, V& greatest) {
    const V a = hn::Mul(hn::Sub(broadcast(node.low), q), n);
    const V b = hn::Mul(hn::Sub(broadcast(node.high), q), n);
    least = hn::Min(a, b);
    greatest = hn::Max(a, b);
  }
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
