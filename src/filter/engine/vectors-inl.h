// Highway's vectors of up to 16 values: of queries, of sources, or of nodes.
#if defined(PSF_FILTER_ENGINE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_VECTORS_INL_H
#undef PSF_FILTER_ENGINE_VECTORS_INL_H
#else
#define PSF_FILTER_ENGINE_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "filter/engine/kernel.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kWidth>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;
using M = hn::Mask<D>;
constexpr D kD;
constexpr DI kDI;
constexpr std::size_t kLanes = hn::MaxLanes(kD);

// The columns of one source, which is the same in every lane.
struct OneSource {
  const float* at;
  [[nodiscard]] HWY_INLINE V column(std::size_t c) const { return hn::Set(kD, at[c * kWidth]); }
};
// The columns of several sources, one per lane.
struct SourceALane {
  const float* at;
  [[nodiscard]] HWY_INLINE V column(std::size_t c) const { return hn::Load(kD, at + c * kWidth); }
};

// The least and the greatest value of a column, in every lane.
struct Interval {
  V low, high;
};

// The columns of a packet's queries: the same interval for every node.
struct PacketBounds {
  const float* low;
  const float* high;
  float least_r_sq, greatest_r_sq;
  float least_reach, greatest_reach;  // t r_i of `plane`

  explicit HWY_INLINE PacketBounds(const Packet& packet) : low(packet.low), high(packet.high) {
    const auto [r, r_end] = std::minmax_element(packet.r_sq, packet.r_sq + kWidth);
    const auto [t, t_end] = std::minmax_element(packet.plane_reach, packet.plane_reach + kWidth);
    least_r_sq = *r;
    greatest_r_sq = *r_end;
    least_reach = *t;
    greatest_reach = *t_end;
  }
  [[nodiscard]] HWY_INLINE Interval interval(std::size_t c) const {
    return {hn::Set(kD, low[c * kWidth]), hn::Set(kD, high[c * kWidth])};
  }
};

// The columns of the nodes of a family from `place` on, one node per lane.
struct FamilyBounds {
  const float* low;
  std::size_t columns, place;

  [[nodiscard]] HWY_INLINE Interval interval(std::size_t c) const {
    return {hn::Load(kD, low + c * kWidth + place),
            hn::Load(kD, low + (columns + c) * kWidth + place)};
  }
};

HWY_INLINE V sum_of_products(V ax, V bx, V ay, V by, V az, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

// The interval of the products of any value in `a` with any value in `b`.
HWY_INLINE Interval product(const Interval& a, const Interval& b) {
  const V ll = hn::Mul(a.low, b.low), lh = hn::Mul(a.low, b.high);
  const V hl = hn::Mul(a.high, b.low), hh = hn::Mul(a.high, b.high);
  return {hn::Min(hn::Min(ll, lh), hn::Min(hl, hh)), hn::Max(hn::Max(ll, lh), hn::Max(hl, hh))};
}
HWY_INLINE Interval sum(const Interval& a, const Interval& b, const Interval& c) {
  return {hn::Add(hn::Add(a.low, b.low), c.low), hn::Add(hn::Add(a.high, b.high), c.high)};
}
HWY_INLINE Interval difference(const Interval& a, const Interval& b) {
  return {hn::Sub(a.low, b.high), hn::Sub(a.high, b.low)};
}

HWY_INLINE std::uint32_t bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kD, mask, bytes);
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

HWY_INLINE M mask_of(std::uint32_t bits) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits),
                                 static_cast<std::uint8_t>(bits >> 8)};
  return hn::LoadMaskBits(kD, bytes);
}

// Writes first + k for each bit k that is set, in ascending order, and returns how many. It writes
// whole vectors, so `out` needs room for kWidth + kLanes values.
HWY_INLINE std::size_t list(std::uint32_t bits, std::int32_t first, std::int32_t* out) {
  std::size_t count = 0;
  for (std::size_t place = 0; place < kWidth; place += kLanes, bits >>= kLanes) {
    const VI numbers = hn::Iota(kDI, first + static_cast<std::int32_t>(place));
    count += hn::CompressStore(numbers, hn::RebindMask(kDI, mask_of(bits)), kDI, out + count);
  }
  return count;
}

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
