// Sums of values in double and their counts, a query a lane.
#if defined(PSF_FILTER_ENGINE_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_SUMS_INL_H
#undef PSF_FILTER_ENGINE_SUMS_INL_H
#else
#define PSF_FILTER_ENGINE_SUMS_INL_H
#endif

#include "filter/engine/terms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

using DD = hn::CappedTag<double, kWidth / 2>;
using VD = hn::Vec<DD>;
using MD = hn::Mask<DD>;
constexpr DD kDD;
// Vectors of doubles for one of floats: two, but where a vector has one lane.
constexpr std::size_t kDoubles = hn::MaxLanes(kDD);
constexpr std::size_t kParts = kLanes / kDoubles;

// The masks of doubles for the lanes of floats.
struct Parts {
  MD mask[kParts];

  explicit HWY_INLINE Parts(M m) {
#if HWY_TARGET == HWY_AVX3
    mask[0] = MD{static_cast<__mmask8>(m.raw)};
    mask[1] = MD{static_cast<__mmask8>(m.raw >> kDoubles)};
#elif HWY_TARGET == HWY_SCALAR
    mask[0] = hn::FirstN(kDD, hn::CountTrue(kD, m));
#else
    constexpr hn::RebindToSigned<DD> kDLI;
    const auto lanes = hn::BitCast(kDI, hn::VecFromMask(kD, m));
    const hn::Half<DI> half;
    const auto lower = hn::PromoteTo(kDLI, hn::LowerHalf(half, lanes));
    const auto upper = hn::PromoteTo(kDLI, hn::UpperHalf(half, lanes));
    mask[0] = hn::RebindMask(kDD, hn::MaskFromVec(lower));
    mask[1] = hn::RebindMask(kDD, hn::MaskFromVec(upper));
#endif
  }
};

// sum + value where the mask is set; adding +0 elsewhere changes no sum, since none is ever -0.
HWY_INLINE VD add_where(MD mask, VD sum, VD value) {
#if HWY_TARGET == HWY_AVX3
  return hn::IfThenElse(mask, hn::Add(sum, value), sum);
#else
  return hn::Add(sum, hn::IfThenElseZero(mask, value));
#endif
}

HWY_INLINE hn::Vec<DI> add_one_where(M mask, hn::Vec<DI> counts) {
  const auto lanes = hn::RebindMask(kDI, mask);
#if HWY_TARGET == HWY_AVX3
  return hn::IfThenElse(lanes, hn::Add(counts, hn::Set(kDI, 1)), counts);
#else
  return hn::Sub(counts, hn::VecFromMask(kDI, lanes));
#endif
}

HWY_INLINE std::uint32_t bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kD, mask, bytes);
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

class Sums {
 public:
  Sums(Packet& packet, std::size_t lane) : packet_(packet), lane_(lane) {}

  HWY_INLINE void set_met_itself(M mask) {
    hn::Store(hn::VecFromMask(kDI, hn::RebindMask(kDI, mask)), kDI, packet_.met_itself + lane_);
  }

  // One value, (3, 16) and this place of it, that stands for `count` sources.
  HWY_INLINE void add(M mask, const double* value, std::size_t count) {
    const Parts parts(mask);
    for (std::size_t c = 0; c < 3; ++c) {
      const VD v = hn::Set(kDD, value[c * kWidth]);
      for (std::size_t part = 0; part < kParts; ++part) {
        double* sum = sums(c, part);
        hn::Store(add_where(parts.mask[part], hn::Load(kDD, sum), v), kDD, sum);
      }
    }
    const auto more = hn::IfThenElseZero(hn::RebindMask(kDI, mask),
                                         hn::Set(kDI, static_cast<std::int32_t>(count)));
    hn::Store(hn::Add(hn::Load(kDI, counts()), more), kDI, counts());
  }

  // The values of a group, one after the other, each where its mask(k) is set.
  template <class Mask>
  HWY_INLINE void add(const Mask& mask, const double* values, std::size_t count) {
    VD sum[3][kParts];
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t part = 0; part < kParts; ++part) {
        sum[c][part] = hn::Load(kDD, sums(c, part));
      }
    }
    auto counted = hn::Load(kDI, counts());
    for (std::size_t k = 0; k < count; ++k) {
      const M m = mask(k);
      const Parts parts(m);
      for (std::size_t c = 0; c < 3; ++c) {
        const VD v = hn::Set(kDD, values[c * kWidth + k]);
        for (std::size_t part = 0; part < kParts; ++part) {
          sum[c][part] = add_where(parts.mask[part], sum[c][part], v);
        }
      }
      counted = add_one_where(m, counted);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t part = 0; part < kParts; ++part) {
        hn::Store(sum[c][part], kDD, sums(c, part));
      }
    }
    hn::Store(counted, kDI, counts());
  }

 private:
  [[nodiscard]] HWY_INLINE double* sums(std::size_t c, std::size_t part) const {
    return packet_.sum[c] + lane_ + part * kDoubles;
  }
  [[nodiscard]] HWY_INLINE std::int32_t* counts() const { return packet_.count + lane_; }

  Packet& packet_;
  std::size_t lane_;
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
