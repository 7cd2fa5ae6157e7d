// The same source once for every instruction set: Highway includes it again for each.
#include "filter/engine/kernel.h"

#include "filter/engine/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/engine/kernel.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include "filter/engine/count-inl.h"
#include "filter/engine/fit-inl.h"
#include "filter/engine/found-inl.h"
#include "filter/engine/rings-inl.h"
#include "filter/engine/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

template <class Tag>
HWY_INLINE void extremes_of(Tag tag, const float* lows, const float* highs, float* low,
                            float* high) {
  auto least = hn::BitCast(tag, hn::Load(kD, lows));
  auto greatest = hn::BitCast(tag, hn::Load(kD, highs));
  for (std::size_t k = kLanes; k < kWidth; k += kLanes) {
    least = hn::Min(least, hn::BitCast(tag, hn::Load(kD, lows + k)));
    greatest = hn::Max(greatest, hn::BitCast(tag, hn::Load(kD, highs + k)));
  }
  *low = hn::GetLane(hn::BitCast(kD, hn::MinOfLanes(tag, least)));
  *high = hn::GetLane(hn::BitCast(kD, hn::MaxOfLanes(tag, greatest)));
}

void extremes_on(const ColumnPlan& plan, std::size_t columns, const float* lows, const float* highs,
                 float* low, float* high) {
  for (std::size_t c = 0; c < columns; ++c) {
    const std::size_t row = c * kWidth;
    if (plan.is_integer(c)) {
      extremes_of(kDI, lows + row, highs + row, low + row, high + row);
    } else {
      extremes_of(kD, lows + row, highs + row, low + row, high + row);
    }
  }
}

void add_sources_on(const Tree& tree, const TreeSums& sums, const WeightTerms& terms,
                    std::span<const std::uint32_t> parents, Packet& packet) {
  SumSink sink(sums, packet);
  SourceWalk(tree, terms, packet, sink).run(parents);
  sink.finish();
}

void find_sources_on(const Tree& tree, const WeightTerms& terms,
                     std::span<const std::uint32_t> parents, Packet& packet, Found& found) {
  found.clear();
  FoundSink sink(found);
  SourceWalk(tree, terms, packet, sink).run(parents);
  count_found(found, packet);
}

void add_found_on(std::span<const TreeSums> sums, const Found& found, double* out) {
  while (!sums.empty()) {
    const std::size_t count = std::min(sums.size(), kValuesAtOnce);
    add_some_values<kValuesAtOnce>(count, sums.data(), found, out);
    out += count * 3 * kWidth;
    sums = sums.subspan(count);
  }
}

void list_found_on(const Tree& tree, const Found& found,
                   std::array<std::vector<std::uint32_t>, kWidth>& places) {
  list_sources(tree, found, places);
}

void find_moments_on(const Tree& tree, const FitSources& sources, const Found& found,
                     const Packet& packet, FitPacket& fit) {
  moments_of_found(tree, sources, found, packet, fit);
}

void add_by_weight_on(const Tree& tree, const FitSources& sources, std::span<const TreeSums> sums,
                      const Found& found, const Packet& packet, const FitPacket& fit, double* out) {
  for (const TreeSums& values : sums) {
    add_weighted(tree, sources, values, found, packet, fit, out);
    out += 3 * kWidth;
  }
}

void average_sums_on(const Packet& packet, std::span<const double> sums, float* means) {
  means_of_sums(packet, sums, means);
}

void add_to_rings_on(const Tree& tree, const TreeSums& sums, const WeightTerms& terms,
                     std::span<const std::uint32_t> parents, Packet& packet,
                     const RingPacket& rings) {
  RingWalk(tree, sums, terms, packet, rings).run(parents);
}

void average_balls_on(const RingPacket& rings, std::size_t q, const RingMeans& means) {
  means_of_balls(rings, q, means);
}

void count_on(const Tree& tree, const WeightTerms& terms, std::span<const std::uint32_t> parents,
              const Packet& packet, PairCounts& counts) {
  CountWalk(tree, terms, packet, counts).run(parents);
}

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace psf::filter::engine {

HWY_EXPORT(extremes_on);
HWY_EXPORT(add_sources_on);
HWY_EXPORT(find_sources_on);
HWY_EXPORT(add_found_on);
HWY_EXPORT(list_found_on);
HWY_EXPORT(find_moments_on);
HWY_EXPORT(add_by_weight_on);
HWY_EXPORT(average_sums_on);
HWY_EXPORT(add_to_rings_on);
HWY_EXPORT(average_balls_on);
HWY_EXPORT(count_on);

void extremes(const ColumnPlan& plan, std::size_t columns, const float* lows, const float* highs,
              float* low, float* high) {
  HWY_DYNAMIC_DISPATCH(extremes_on)(plan, columns, lows, highs, low, high);
}
void add_sources(const Tree& tree, const TreeSums& sums, const WeightTerms& terms,
                 std::span<const std::uint32_t> parents, Packet& packet) {
  HWY_DYNAMIC_DISPATCH(add_sources_on)(tree, sums, terms, parents, packet);
}
void find_sources(const Tree& tree, const WeightTerms& terms,
                  std::span<const std::uint32_t> parents, Packet& packet, Found& found) {
  HWY_DYNAMIC_DISPATCH(find_sources_on)(tree, terms, parents, packet, found);
}
void add_found(std::span<const TreeSums> sums, const Found& found, double* out) {
  HWY_DYNAMIC_DISPATCH(add_found_on)(sums, found, out);
}
void list_found(const Tree& tree, const Found& found,
                std::array<std::vector<std::uint32_t>, kWidth>& places) {
  HWY_DYNAMIC_DISPATCH(list_found_on)(tree, found, places);
}
void find_moments(const Tree& tree, const FitSources& sources, const Found& found,
                  const Packet& packet, FitPacket& fit) {
  HWY_DYNAMIC_DISPATCH(find_moments_on)(tree, sources, found, packet, fit);
}
void add_by_weight(const Tree& tree, const FitSources& sources, std::span<const TreeSums> sums,
                   const Found& found, const Packet& packet, const FitPacket& fit, double* out) {
  HWY_DYNAMIC_DISPATCH(add_by_weight_on)(tree, sources, sums, found, packet, fit, out);
}
void average_sums(const Packet& packet, std::span<const double> sums, float* means) {
  HWY_DYNAMIC_DISPATCH(average_sums_on)(packet, sums, means);
}
void add_to_rings(const Tree& tree, const TreeSums& sums, const WeightTerms& terms,
                  std::span<const std::uint32_t> parents, Packet& packet, const RingPacket& rings) {
  HWY_DYNAMIC_DISPATCH(add_to_rings_on)(tree, sums, terms, parents, packet, rings);
}
void average_balls(const RingPacket& rings, std::size_t q, const RingMeans& means) {
  HWY_DYNAMIC_DISPATCH(average_balls_on)(rings, q, means);
}
void count_pairs(const Tree& tree, const WeightTerms& terms, std::span<const std::uint32_t> parents,
                 const Packet& packet, PairCounts& counts) {
  HWY_DYNAMIC_DISPATCH(count_on)(tree, terms, parents, packet, counts);
}

}  // namespace psf::filter::engine
#endif
