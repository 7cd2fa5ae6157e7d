// Lists the sources of a walk, and adds up what was listed.
#if defined(PSF_FILTER_ENGINE_FOUND_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_FOUND_INL_H
#undef PSF_FILTER_ENGINE_FOUND_INL_H
#else
#define PSF_FILTER_ENGINE_FOUND_INL_H
#endif

#include <bit>

#include "filter/engine/found.h"
#include "filter/engine/sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

class FoundSink {
 public:
  explicit FoundSink(Found& found) : found_(found) {}

  HWY_INLINE void add_nodes(LevelName level, std::size_t family, std::uint32_t bits,
                            std::size_t count) {
    found_.nodes.push_back({level, family, bits, count});
  }
  template <class Visit>
  HWY_INLINE void add_sources(std::size_t lane, std::size_t most, const Visit& walk) {
    Found::List& list = found_.sources[lane / kLanes];
    Found::Source* const out = list.room_for(most);
    std::size_t count = 0;
    walk([&](M lanes, std::size_t place) HWY_ATTR {
      const std::uint32_t bits = bits_of(lanes);
      out[count] = {static_cast<std::uint32_t>(place), bits};
      count += bits != 0 ? 1 : 0;
    });
    list.grow_by(count);
  }
  [[nodiscard]] HWY_INLINE std::size_t group(std::size_t g) const { return g * kWidth; }

 private:
  Found& found_;
};

// Sets packet.count.
HWY_INLINE void count_found(const Found& found, Packet& packet) {
  std::size_t all = 0;
  for (const Found::Nodes& nodes : found.nodes) all += nodes.count;
  for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
    VI counted = hn::Set(kDI, static_cast<std::int32_t>(all));
    for (const Found::Source& source : found.sources[lane / kLanes]) {
      counted = add_one_where(mask_of(source.lanes), counted);
    }
    hn::Store(counted, kDI, packet.count + lane);
  }
}

// Appends the places of what was found to the list of each query.
HWY_INLINE void list_sources(const Tree& tree, const Found& found,
                             std::array<std::vector<std::uint32_t>, kWidth>& places) {
  for (const auto& [level, family, bits, unused] : found.nodes) {
    for (std::uint32_t rest = bits; rest != 0; rest &= rest - 1) {
      const std::size_t node = family * kWidth + static_cast<std::size_t>(std::countr_zero(rest));
      const std::size_t first = node * kRecordsBelow[level];
      for (std::size_t place = first; place < first + tree.size_of(level, node); ++place) {
        for (auto& of_query : places) of_query.push_back(static_cast<std::uint32_t>(place));
      }
    }
  }
  for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
    for (const auto& [place, lanes] : found.sources[lane / kLanes]) {
      for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
        places[lane + static_cast<std::size_t>(std::countr_zero(rest))].push_back(place);
      }
    }
  }
}

// As many values as have their sums in registers, of which there are 16, or 32. A value has six.
constexpr std::size_t kValuesAtOnce = kLanes == kWidth ? 5 : 2;

// Sets `out`, (kCount, 3, 16), for kCount values, by the additions of SumSink.
template <std::size_t kCount>
HWY_INLINE void add_values(const TreeSums* sums, const Found& found, double* out) {
  VD of_nodes[kCount][3];
  for (std::size_t v = 0; v < kCount; ++v) {
    WholeSums whole;
    for (const auto& [level, family, bits, sources] : found.nodes) {
      whole.add(sums[v].below(level, family), bits, sources);
    }
    for (std::size_t c = 0; c < 3; ++c) of_nodes[v][c] = hn::Set(kDD, whole.total(c));
  }
  for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
    VD total[kCount][3][kParts];
    for (auto& value : total) {
      for (auto& sum : value) {
        for (VD& part : sum) part = hn::Zero(kDD);
      }
    }
    for (const auto& [place, lanes] : found.sources[lane / kLanes]) {
      const Parts parts(mask_of(lanes));
      const std::size_t at = place / kWidth * 3 * kWidth + place % kWidth;
      for (std::size_t v = 0; v < kCount; ++v) {
        const double* value = sums[v].values(0) + at;
        for (std::size_t c = 0; c < 3; ++c) {
          const VD one = hn::Set(kDD, value[c * kWidth]);
          for (std::size_t part = 0; part < kParts; ++part) {
            total[v][c][part] = add_where(parts.mask[part], total[v][c][part], one);
          }
        }
      }
    }
    for (std::size_t v = 0; v < kCount; ++v) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t part = 0; part < kParts; ++part) {
          hn::Store(hn::Add(total[v][c][part], of_nodes[v][c]), kDD,
                    out + (3 * v + c) * kWidth + lane + part * kDoubles);
        }
      }
    }
  }
}

// The same for `count` values, at most kMost.
template <std::size_t kMost>
HWY_INLINE void add_some_values(std::size_t count, const TreeSums* sums, const Found& found,
                                double* out) {
  if constexpr (kMost > 1) {
    if (count < kMost) return add_some_values<kMost - 1>(count, sums, found, out);
  }
  add_values<kMost>(sums, found, out);
}

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
