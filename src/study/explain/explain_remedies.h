// What an explained pixel would be with other weights, and which term would have refused a leak.
#pragma once

#include <array>
#include <vector>

#include "filter/weights.h"
#include "study/explain/explain_whence.h"

namespace psf::study {

// By term of filter::kTermNames.
[[nodiscard]] std::array<bool, filter::kTermCount> terms_on(const filter::WeightTerms& terms);

// The pixel if others of the pairs in the balls were averaged.
class PixelIf {
 public:
  explicit PixelIf(const Explanation& explanation) : e_(explanation) {}

  [[nodiscard]] Colour unfiltered(std::uint32_t vertex) const;  // u_i
  // `accepts` says of a pair in a ball, not the path's own, whether it is averaged. A path that is
  // left without any keeps what it has.
  template <typename Accepts>
  [[nodiscard]] Colour operator()(Accepts accepts) const {
    Colour sum(0, 0, 0);
    std::uint64_t counted = 0;
    for (const ExplainedPath& path : e_.paths) {
      if (path.fate == PathFate::left_out || path.fate == PathFate::overflowed) continue;
      ++counted;
      sum += unfiltered(path.vertex);
      if (path.fate == PathFate::no_vertex) continue;
      Averaged averaged;
      for (std::size_t p = path.begin; p < path.end; ++p) {
        const ExplainedPair& pair = e_.pairs[p];
        if (pair.in_ball && (pair.self || accepts(pair)))
          averaged.add(e_.value[pair.vertex], pair.area);
      }
      sum += reflected(path, averaged);
    }
    return counted > 0 ? sum / static_cast<double>(counted) : sum;
  }

 private:
  struct Averaged {
    Colour sum{0, 0, 0};
    std::uint64_t count = 0;
    void add(const Rgb& value, float area);
  };
  [[nodiscard]] Colour reflected(const ExplainedPath& path, const Averaged& averaged) const;

  const Explanation& e_;
};

// Whence::remedies. leaking[v]: vertex v is one of the sources that make up the difference.
[[nodiscard]] std::vector<Remedy> find_remedies(const Explanation& explanation,
                                                const PixelIf& pixel_if,
                                                const std::vector<bool>& leaking);

}  // namespace psf::study
