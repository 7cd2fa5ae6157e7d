// Counts the pairs in the balls and what each term refuses of them: for the statistics alone, so it
// takes its time.
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
  CountWalk(const Tree& tree, const WeightTerms& on, const Packet& packet, std::size_t lane,
            PairCounts& counts)
      : tree_(tree), terms_(tree.plan(), on, packet, lane), reach_(packet, lane), counts_(counts) {}

  HWY_INLINE void run(std::span<const std::uint32_t> nodes) {
    if (reach_.is_empty()) return;
    for (const std::uint32_t node : nodes) {
      const Bounds family = node_bounds(tree_, 0, std::size_t{node} * kWidth);
      for (std::uint32_t children = reach_.children(family); children != 0;
           children &= children - 1) {
        const std::size_t group = node * kWidth + static_cast<unsigned>(std::countr_zero(children));
        if (group < tree_.nodes(0) && !decided(group)) records(group);
      }
    }
  }

 private:
  static constexpr unsigned kChi = Terms::kChi;

  [[nodiscard]] std::size_t size_of(std::size_t group) const {
    return std::min(kWidth, tree_.size() - group * kWidth);
  }
  template <class Count>
  HWY_INLINE void each_term(const Count& count) const {
    for (unsigned left = terms_.bits() & ~kChi; left != 0; left &= left - 1) {
      count(left & (~left + 1), static_cast<std::size_t>(std::countr_zero(left)));
    }
  }

  // Counts the group as a whole where its bounds decide chi and every term for every lane.
  HWY_INLINE bool decided(std::size_t group) {
    const Bounds bounds = node_bounds(tree_, 0, group);
    const M lanes = terms_.queries();
    Verdict chi;
    terms_.with(kChi, [&](const auto& term, std::size_t c) { chi = term.judge(bounds.column(c)); });
    const M in = hn::And(lanes, chi.every);
    if (!hn::AllFalse(kD, hn::AndNot(hn::Or(chi.none, chi.every), lanes))) return false;
    PairCounts counts;
    counts.candidates = hn::CountTrue(kD, in) * size_of(group);
    bool all = true;
    each_term([&](unsigned bit, std::size_t k) {
      terms_.with(bit, [&](const auto& term, std::size_t c) {
        const Verdict verdict = term.judge(bounds.column(c));
        all = all && hn::AllFalse(kD, hn::AndNot(hn::Or(verdict.none, verdict.every), in));
        counts.refused[k] = hn::CountTrue(kD, hn::And(in, verdict.none)) * size_of(group);
      });
    });
    if (all) counts_ += counts;
    return all;
  }

  HWY_INLINE void records(std::size_t group) {
    const float* columns = tree_.group(group);
    for (std::size_t place = 0; place < size_of(group); ++place) {
      M in = terms_.queries();
      terms_.with(kChi, [&](const auto& term, std::size_t c) {
        in = hn::And(in, term.pass(OneSource{columns + c * kWidth + place}));
      });
      counts_.candidates += hn::CountTrue(kD, in);
      each_term([&](unsigned bit, std::size_t k) {
        terms_.with(bit, [&](const auto& term, std::size_t c) {
          const M pass = term.pass(OneSource{columns + c * kWidth + place});
          counts_.refused[k] += hn::CountTrue(kD, hn::AndNot(pass, in));
        });
      });
    }
  }

  const Tree& tree_;
  Terms terms_;
  Reach reach_;
  PairCounts& counts_;
};

}  // namespace psf::filter::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
