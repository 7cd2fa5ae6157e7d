// Moments of [fit] over what a walk found, and sums with the weights that come of them.
#if defined(PSF_FILTER_ENGINE_FIT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_FIT_INL_H
#undef PSF_FILTER_ENGINE_FIT_INL_H
#else
#define PSF_FILTER_ENGINE_FIT_INL_H
#endif

#include "filter/engine/found-inl.h"
#include "filter/engine/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

// Call visit(lanes, place) for the sources of the queries in the lanes from `lane` on, in the order
// in which they were found: those below whole nodes, which every query takes, and the others.
template <class Visit>
HWY_INLINE void each_below_nodes(const Tree& tree, const Found& found, const Visit& visit) {
  const M all = hn::FirstN(kD, kLanes);
  for (const auto& [level, family, bits, count] : found.nodes) {
    for (std::uint32_t left = bits; left != 0; left &= left - 1) {
      const std::size_t node = family * kWidth + lowest_bit(left);
      const std::size_t first = node * kRecordsBelow[level];
      const std::size_t end = first + tree.size_of(level, node);
      for (std::size_t place = first; place < end; ++place) visit(all, place);
    }
  }
}
template <class Visit>
HWY_INLINE void each_single(const Found& found, std::size_t lane, const Visit& visit) {
  for (const auto& [place, lanes] : found.sources[lane / kLanes]) visit(mask_of(lanes), place);
}

// Three values for each lane.
struct Triple {
  V x, y, z;

  static HWY_INLINE Triple load(const float (&rows)[3][kWidth], std::size_t lane) {
    return {hn::Load(kD, rows[0] + lane), hn::Load(kD, rows[1] + lane),
            hn::Load(kD, rows[2] + lane)};
  }
  [[nodiscard]] HWY_INLINE V dot(const Triple& other) const {
    return sum_of_products(x, other.x, y, other.y, z, other.z);
  }
  // Of a source, whose three values are rows of a group, the difference from these.
  [[nodiscard]] HWY_INLINE Triple to(const float* source) const {
    return {hn::Sub(hn::Set(kD, source[0]), x), hn::Sub(hn::Set(kD, source[kWidth]), y),
            hn::Sub(hn::Set(kD, source[2 * kWidth]), z)};
  }
};

// x_j - x_i and y_j - y_i of any source for the queries in some lanes.
class Away {
 public:
  HWY_INLINE Away(const Tree& tree, const FitSources& sources, const Packet& packet,
                  const FitPacket& fit, std::size_t lane)
      : tree_(tree), sources_(sources), own_(Triple::load(fit.own, lane)) {
    const float* x = packet.columns + lane;
    at_ = {hn::Load(kD, x), hn::Load(kD, x + kWidth), hn::Load(kD, x + 2 * kWidth)};
  }
  [[nodiscard]] HWY_INLINE Triple in_place(std::size_t place) const {
    return at_.to(tree_.group(place / kWidth) + place % kWidth);
  }
  [[nodiscard]] HWY_INLINE Triple in_facing(std::size_t place) const {
    return own_.to(sources_.facing(place / kWidth) + place % kWidth);
  }

 private:
  const Tree& tree_;
  const FitSources& sources_;
  Triple at_, own_;
};

// The lanes of a part of a vector of floats, as doubles.
HWY_INLINE void promote(V values, VD (&parts)[kParts]) {
  alignas(64) float lanes[kLanes];
  hn::Store(values, kD, lanes);
  constexpr hn::Rebind<float, DD> floats;
  for (std::size_t part = 0; part < kParts; ++part) {
    parts[part] = hn::PromoteTo(kDD, hn::LoadU(floats, lanes + part * kDoubles));
  }
}

// Sums of floats that stay exact over many sources: what lies below a parent is added up in float,
// and such sums in double. Call finish() between whole nodes and single sources: the first of these
// may lie below the last parent of those or not, by lane, and bytes would depend on the width of a
// vector.
class MomentSums {
 public:
  HWY_INLINE MomentSums() {
    for (V& s : part_) s = hn::Zero(kD);
    for (auto& of_lanes : whole_) {
      for (double& s : of_lanes) s = 0;
    }
  }
  // Before the moments of a source are added.
  HWY_INLINE void begin(std::size_t place) {
    const std::size_t parent = place / kRecordsBelow[kParents];
    if (parent == parent_) return;
    finish();
    parent_ = parent;
  }
  HWY_INLINE void add(std::size_t k, V value) { part_[k] = hn::Add(part_[k], value); }
  HWY_INLINE void finish() {
    for (std::size_t k = 0; k < kCount; ++k) {
      VD parts[kParts];
      promote(part_[k], parts);
      for (std::size_t part = 0; part < kParts; ++part) {
        double* whole = whole_[k] + part * kDoubles;
        hn::Store(hn::Add(hn::Load(kDD, whole), parts[part]), kDD, whole);
      }
      part_[k] = hn::Zero(kD);
    }
  }
  [[nodiscard]] HWY_INLINE const double* whole(std::size_t k) const { return whole_[k]; }

 private:
  static constexpr std::size_t kCount = kFeatures + kFeatureProducts;
  V part_[kCount];
  alignas(64) double whole_[kCount][kLanes];
  std::size_t parent_ = 0;
};

HWY_INLINE void moments_of_found(const Tree& tree, const FitSources& sources, const Found& found,
                                 const Packet& packet, FitPacket& fit) {
  for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
    const Away away(tree, sources, packet, fit, lane);
    Triple axes[kFeatures];
    for (std::size_t k = 0; k < 2; ++k) {
      axes[k] = Triple::load(fit.place[k], lane);
      axes[2 + k] = Triple::load(fit.facing[k], lane);
    }
    MomentSums sums;
    VD luminance_sq[kParts];
    for (VD& s : luminance_sq) s = hn::Zero(kDD);
    const auto add = [&](M lanes, std::size_t place) HWY_ATTR {
      sums.begin(place);
      const Triple x = away.in_place(place), y = away.in_facing(place);
      V f[kFeatures];
      for (std::size_t k = 0; k < kFeatures; ++k) {
        f[k] = hn::IfThenElseZero(lanes, axes[k].dot(k < 2 ? x : y));
        sums.add(k, f[k]);
        for (std::size_t l = 0; l <= k; ++l)
          sums.add(kFeatures + product_at(k, l), hn::Mul(f[k], f[l]));
      }
      const Parts parts(lanes);
      const VD y_sq = hn::Set(kDD, sources.luminance_sq(0)[place]);
      for (std::size_t part = 0; part < kParts; ++part) {
        luminance_sq[part] = add_where(parts.mask[part], luminance_sq[part], y_sq);
      }
    };
    each_below_nodes(tree, found, add);
    sums.finish();
    each_single(found, lane, add);
    sums.finish();
    for (std::size_t k = 0; k < kLanes; ++k) {
      for (std::size_t f = 0; f < kFeatures; ++f) fit.sum[f][lane + k] = sums.whole(f)[k];
      for (std::size_t p = 0; p < kFeatureProducts; ++p)
        fit.product[p][lane + k] = sums.whole(kFeatures + p)[k];
    }
    for (std::size_t part = 0; part < kParts; ++part) {
      hn::Store(luminance_sq[part], kDD, fit.luminance_sq + lane + part * kDoubles);
    }
  }
}

// Sets `out`, (3, 16), to the sums of the weights times the values of one of the averages.
HWY_INLINE void add_weighted(const Tree& tree, const FitSources& sources, const TreeSums& values,
                             const Found& found, const Packet& packet, const FitPacket& fit,
                             double* out) {
  for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
    const Away away(tree, sources, packet, fit, lane);
    const Triple by_place = Triple::load(fit.by_place, lane);
    const Triple by_facing = Triple::load(fit.by_facing, lane);
    const V at_mean = hn::Load(kD, fit.at_mean + lane);
    VD total[3][kParts];
    for (auto& sum : total) {
      for (VD& part : sum) part = hn::Zero(kDD);
    }
    const auto add = [&](M lanes, std::size_t place) HWY_ATTR {
      const V along_slope =
          hn::Add(by_place.dot(away.in_place(place)), by_facing.dot(away.in_facing(place)));
      VD weight[kParts];
      promote(hn::IfThenElseZero(lanes, hn::Sub(at_mean, along_slope)), weight);
      const double* value = values.values(place / kWidth) + place % kWidth;
      for (std::size_t c = 0; c < 3; ++c) {
        const VD one = hn::Set(kDD, value[c * kWidth]);
        for (std::size_t part = 0; part < kParts; ++part) {
          total[c][part] = hn::Add(total[c][part], hn::Mul(weight[part], one));
        }
      }
    };
    each_below_nodes(tree, found, add);
    each_single(found, lane, add);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t part = 0; part < kParts; ++part) {
        hn::Store(total[c][part], kDD, out + c * kWidth + lane + part * kDoubles);
      }
    }
  }
}

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
