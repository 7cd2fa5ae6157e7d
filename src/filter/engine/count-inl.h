// Counts the pairs in the balls, and how many of them each term refuses. It serves the statistics
// alone, and is not made to be fast.
#if defined(PSF_FILTER_ENGINE_COUNT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PSF_FILTER_ENGINE_COUNT_INL_H
#undef PSF_FILTER_ENGINE_COUNT_INL_H
#else
#define PSF_FILTER_ENGINE_COUNT_INL_H
#endif

#include "filter/engine/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace psf::filter::engine::HWY_NAMESPACE {

class CountWalk {
 public:
  CountWalk(const Tree& tree, const WeightTerms& on, const Packet& packet, PairCounts& counts)
      : tree_(tree),
        on_(on),
        packet_(packet),
        counts_(counts),
        terms_(tree.plan(), on, packet, 0),
        judge_(tree, terms_, packet) {}

  HWY_INLINE void run(std::span<const std::uint32_t> parents) {
    for (const std::uint32_t parent : parents) {
      const Balls balls(judge_.queries(), tree_.bounds(kGroups, parent), tree_.plan().count);
      for (std::uint32_t left = balls.touched & judge_.groups_of(parent); left != 0;
           left &= left - 1) {
        const std::size_t group = parent * kWidth + lowest_bit(left);
        for (std::size_t lane = 0; lane < kWidth; lane += kLanes) count(group, lane);
      }
    }
  }

 private:
  HWY_INLINE void count(std::size_t group, std::size_t lane) {
    const Terms terms(tree_.plan(), on_, packet_, lane);
    const Chi chi = terms.chi();
    for (std::size_t k = 0; k < tree_.size_of(kGroups, group); ++k) {
      const float* source = tree_.group(group) + k;
      const M in = chi.pass(OneSource{source});
      counts_.candidates += hn::CountTrue(kD, in);
      terms.each(terms.bits(), [&](std::size_t term_number, const auto& term, std::size_t c) {
        const M pass = term.pass(OneSource{source + c * kWidth});
        counts_.refused[term_number] += hn::CountTrue(kD, hn::AndNot(pass, in));
      });
    }
  }

  const Tree& tree_;
  const WeightTerms& on_;
  const Packet& packet_;
  PairCounts& counts_;
  Terms terms_;
  Judge judge_;
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
