// Turns sums into means, those over rings into means over balls.
#if defined(PSF_FILTER_ENGINE_MEANS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_MEANS_INL_H
#undef PSF_FILTER_ENGINE_MEANS_INL_H
#else
#define PSF_FILTER_ENGINE_MEANS_INL_H
#endif

#include "filter/engine/sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

// `sums` and `means` are (rows, 16).
HWY_INLINE void means_of_sums(const Packet& packet, std::span<const double> sums, float* means) {
  constexpr hn::Rebind<std::int32_t, DD> integers;
  constexpr hn::Rebind<float, DD> floats;
  for (std::size_t lane = 0; lane < kWidth; lane += kDoubles) {
    const VD count = hn::PromoteTo(kDD, hn::LoadU(integers, packet.count + lane));
    for (std::size_t at = lane; at < sums.size(); at += kWidth) {
      const VD mean = hn::Div(hn::Load(kDD, sums.data() + at), count);
      hn::StoreU(hn::DemoteTo(floats, mean), floats, means + at);
    }
  }
}

// Four doubles: red, green, blue and a count.
struct Quadruple {
  using Tag = hn::CappedTag<double, 4>;
  static constexpr Tag kTag{};
  static constexpr std::size_t kStep = hn::MaxLanes(kTag);
  using Vector = hn::Vec<Tag>;

  Vector part[4 / kStep];

  static HWY_INLINE Quadruple load(const double* at) {
    Quadruple q;
    for (std::size_t k = 0; k < 4; k += kStep) q.part[k / kStep] = hn::Load(kTag, at + k);
    return q;
  }
  HWY_INLINE void store(double* to) const {
    for (std::size_t k = 0; k < 4; k += kStep) hn::Store(part[k / kStep], kTag, to + k);
  }
  // Writes all four values as floats, the count too.
  HWY_INLINE void store(float* to) const {
    constexpr hn::Rebind<float, Tag> floats;
    for (std::size_t k = 0; k < 4; k += kStep) {
      hn::StoreU(hn::DemoteTo(floats, part[k / kStep]), floats, to + k);
    }
  }
  HWY_INLINE Quadruple operator+(const Quadruple& other) const {
    Quadruple sum;
    for (std::size_t k = 0; k < 4 / kStep; ++k) sum.part[k] = hn::Add(part[k], other.part[k]);
    return sum;
  }
  HWY_INLINE Quadruple operator*(double factor) const {
    Quadruple product;
    for (std::size_t k = 0; k < 4 / kStep; ++k) {
      product.part[k] = hn::Mul(part[k], hn::Set(kTag, factor));
    }
    return product;
  }
};

HWY_INLINE void means_of_balls(const RingPacket& rings, std::size_t q, const RingMeans& means) {
  const std::size_t count = rings.count;
  double* balls = means.balls;
  double* inverse = means.inverse;
  const auto of_ring = [&](std::size_t k) HWY_ATTR {
    return Quadruple::load(rings.sums + (k * kWidth + q) * 4) +
           Quadruple::load(rings.whole + k * 4);
  };
  Quadruple ball = of_ring(0);
  for (std::size_t k = 0;;) {
    ball.store(balls + 4 * k);
    inverse[k] = balls[4 * k + 3];
    if (++k == count) break;
    ball = ball + of_ring(k);
  }
  // Divisions take most of the time here. So each ball has one division for its three colours, and
  // a vector of balls is divided at once.
  for (std::size_t k = 0; k < count; k += kDoubles) {
    hn::Store(hn::Div(hn::Set(kDD, 1), hn::Load(kDD, inverse + k)), kDD, inverse + k);
  }
  // Multiplying by 1 / n also gives the exact mean of n equal values.
  for (std::size_t k = 0; k < count; ++k) {
    (Quadruple::load(balls + 4 * k) * inverse[k]).store(means.average + 3 * k);
    means.neighbors[k] = static_cast<std::uint32_t>(balls[4 * k + 3]);
  }
}

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
