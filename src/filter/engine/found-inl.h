// Lists the sources of a walk, and goes through the list again.
#if defined(PSF_FILTER_ENGINE_FOUND_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_FOUND_INL_H
#undef PSF_FILTER_ENGINE_FOUND_INL_H
#else
#define PSF_FILTER_ENGINE_FOUND_INL_H
#endif

#include "filter/engine/found.h"
#include "filter/engine/vectors-inl.h"

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

// Gives `sink` what was found, in the order of the walk.
template <class Sink>
HWY_INLINE void replay(const Found& found, Sink& sink) {
  for (const auto& [level, family, bits, count] : found.nodes) {
    sink.add_nodes(level, family, bits, count);
  }
  for (std::size_t lane = 0; lane < kWidth; lane += kLanes) {
    const Found::List& list = found.sources[lane / kLanes];
    sink.add_sources(lane, 0, [&](auto&& add) HWY_ATTR {
      for (const auto& [place, lanes] : list) {
        add(mask_of(lanes), sink.group(place / kWidth) + place % kWidth);
      }
    });
  }
}

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
