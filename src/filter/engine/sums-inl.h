// Sums of values in double and their counts, one query per lane.
#if defined(PSF_FILTER_ENGINE_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_SUMS_INL_H
#undef PSF_FILTER_ENGINE_SUMS_INL_H
#else
#define PSF_FILTER_ENGINE_SUMS_INL_H
#endif

#include "filter/engine/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

using DD = hn::CappedTag<double, kWidth / 2>;
using VD = hn::Vec<DD>;
using MD = hn::Mask<DD>;
constexpr DD kDD;
// The number of vectors of doubles for one vector of floats: two, or one where a vector has one
// lane.
constexpr std::size_t kDoubles = hn::MaxLanes(kDD);
constexpr std::size_t kParts = kLanes / kDoubles;

// The mask of a vector of floats, as masks of the vectors of doubles for the same lanes.
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

HWY_INLINE VI add_one_where(M mask, VI count) {
  const auto lanes = hn::RebindMask(kDI, mask);
#if HWY_TARGET == HWY_AVX3
  return hn::IfThenElse(lanes, hn::Add(count, hn::Set(kDI, 1)), count);
#else
  return hn::Sub(count, hn::VecFromMask(kDI, lanes));
#endif
}

// The sums of nodes that pass as a whole for every query of a packet: sixteen sums, one for each
// place in a family, however many lanes a vector has.
class WholeSums {
 public:
  HWY_INLINE WholeSums() {
    for (auto& sum : sum_) {
      for (double& at_place : sum) at_place = 0;
    }
  }

  // Adds the nodes of a family whose bits are set in `bits`. `sums`: the family's sums, (3, 16);
  // `sources`: the number of sources below these nodes.
  HWY_INLINE void add(const double* sums, std::uint32_t bits, std::size_t sources) {
    sources_ += sources;
    for (std::size_t place = 0; place < kWidth; place += kLanes) {
      const Parts parts(mask_of(bits >> place));
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t part = 0; part < kParts; ++part) {
          const std::size_t at = place + part * kDoubles;
          const VD value = hn::Load(kDD, sums + c * kWidth + at);
          hn::Store(add_where(parts.mask[part], hn::Load(kDD, sum_[c] + at), value), kDD,
                    sum_[c] + at);
        }
      }
    }
  }

  // The sum of component c over all places.
  [[nodiscard]] HWY_INLINE double total(std::size_t c) const {
    double total = 0;
    for (const double at_place : sum_[c]) total += at_place;
    return total;
  }

  // Adds these sums to those of every query of `packet`.
  HWY_INLINE void add_to(Packet& packet) const {
    if (sources_ == 0) return;
    for (std::size_t c = 0; c < 3; ++c) {
      const double of_nodes = total(c);
      for (double& sum : packet.sum[c]) sum += of_nodes;
    }
    for (std::int32_t& count : packet.count) count += static_cast<std::int32_t>(sources_);
  }

 private:
  alignas(64) double sum_[3][kWidth];
  std::size_t sources_ = 0;
};

// The sums of the queries in kLanes lanes of a packet, from `lane` on.
class Sums {
 public:
  Sums(Packet& packet, std::size_t lane) : packet_(packet), lane_(lane) {}

  // Calls walk(add). `walk` calls add(lanes, value) for each source: it adds the source's value, of
  // which `value` points to the first component in a group's (3, 16) values, to the masked lanes.
  template <class Visit>
  HWY_INLINE void add(const Visit& walk) {
    VD total[3][kParts];  // kept in registers during the walk
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t part = 0; part < kParts; ++part) {
        total[c][part] = hn::Load(kDD, sum(c, part));
      }
    }
    VI counted = hn::Load(kDI, packet_.count + lane_);
    walk([&](M lanes, const double* value) HWY_ATTR {
      const Parts parts(lanes);
      for (std::size_t c = 0; c < 3; ++c) {
        const VD v = hn::Set(kDD, value[c * kWidth]);
        for (std::size_t part = 0; part < kParts; ++part) {
          total[c][part] = add_where(parts.mask[part], total[c][part], v);
        }
      }
      counted = add_one_where(lanes, counted);
    });
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t part = 0; part < kParts; ++part) {
        hn::Store(total[c][part], kDD, sum(c, part));
      }
    }
    hn::Store(counted, kDI, packet_.count + lane_);
  }

 private:
  [[nodiscard]] HWY_INLINE double* sum(std::size_t c, std::size_t part) const {
    return packet_.sum[c] + lane_ + part * kDoubles;
  }

  Packet& packet_;
  std::size_t lane_;
};

// Adds up the values of the sources that a walk finds, at once.
class SumSink {
 public:
  SumSink(const TreeSums& sums, Packet& packet) : sums_(sums), packet_(packet) {}

  HWY_INLINE void add_nodes(LevelName level, std::size_t family, std::uint32_t bits,
                            std::size_t count) {
    whole_.add(sums_.below(level, family), bits, count);
  }
  template <class Visit>
  HWY_INLINE void add_sources(std::size_t lane, std::size_t, const Visit& walk) {
    Sums(packet_, lane).add(walk);
  }
  [[nodiscard]] HWY_INLINE const double* group(std::size_t g) const { return sums_.values(g); }

  HWY_INLINE void finish() const { whole_.add_to(packet_); }

 private:
  const TreeSums& sums_;
  Packet& packet_;
  WholeSums whole_;
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
