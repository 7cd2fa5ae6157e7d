// The value that an explained pixel would have with other weights, and the terms that would have
// refused a leak.
#pragma once

#include <array>
#include <vector>

#include "explain/attribution.h"
#include "explain/path_fit.h"
#include "filter/weights.h"

namespace psf::explain {

// The value of the pixel if other pairs in the balls were averaged.
class PixelIf {
 public:
  explicit PixelIf(const ExplainResult& explanation) : e_(explanation) {}

  [[nodiscard]] Colour unfiltered(std::uint32_t vertex) const;  // u_i
  // The pixel if exactly those pairs were averaged for which `accepts` is true, and the pairs of a
  // path with itself. A path that is left without any pair keeps its average. Fireflies give as they
  // do, but for what `accepts` refuses and the weights do not.
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
        const bool accepted = pair.self || accepts(pair);
        if (pair.in_ball && accepted) add(pair, averaged);
        if (pair.given > 0 && (accepted || pair.refusers != 0))
          averaged.given += given_of(e_, pair, 1);
      }
      sum += reflected(path, averaged);
    }
    return counted > 0 ? sum / static_cast<double>(counted) : sum;
  }

 private:
  struct Averaged {
    Colour sum{0, 0, 0};
    std::uint64_t count = 0;
    std::vector<FitSource> fitted;  // with [fit]
    Colour given{0, 0, 0};          // times alpha_i and rho_i
  };
  void add(const ExplainedPair& pair, Averaged& averaged) const;
  [[nodiscard]] Colour reflected(const ExplainedPath& path, const Averaged& averaged) const;

  const ExplainResult& e_;
};

// Finds Attribution::remedies. leaking[v]: whether vertex v is one of the sources that make up the
// difference.
[[nodiscard]] std::vector<Remedy> find_remedies(const ExplainResult& explanation,
                                                const PixelIf& pixel_if,
                                                const std::vector<bool>& leaking);

}  // namespace psf::explain
