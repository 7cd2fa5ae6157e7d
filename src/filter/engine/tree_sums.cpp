#include "filter/engine/tree_sums.h"

#include <algorithm>

#include "core/parallel.h"

namespace psf::filter::engine {
namespace {

constexpr std::size_t kSumsGrain = 16;  // parents a range

}  // namespace

TreeSums::TreeSums(const Tree& tree, std::span<const Rgb> values, std::span<const float> area)
    : values_(tree.nodes(kGroups) * 3 * kWidth) {
  for (const LevelName level : {kQuads, kGroups, kParents}) {
    sums_[level] = core::Buffer<double>(core::range_count(tree.nodes(level), kWidth) * 3 * kWidth);
  }
  const std::span<const std::uint32_t> order = tree.order();
  const std::size_t size = tree.size(), groups = tree.nodes(kGroups);
  core::parallel_for(tree.nodes(kParents), kSumsGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin * kWidth; g < std::min(groups, end * kWidth); ++g) {
      double* out = &values_[g * 3 * kWidth];
      for (std::size_t k = 0; k < kWidth; ++k) {
        const std::size_t p = g * kWidth + k;
        const std::uint32_t j = order[std::min(p, size - 1)];
        const double weight = p >= size ? 0 : area.empty() ? 1 : double{area[j]};
        out[k] = weight * double{values[j].x};
        out[kWidth + k] = weight * double{values[j].y};
        out[2 * kWidth + k] = weight * double{values[j].z};
      }
    }
    for (std::size_t p = begin; p < end; ++p) add_up(tree, p);
  });
}

// The sums of the quads of a parent, of its groups, and its own.
void TreeSums::add_up(const Tree& tree, std::size_t p) {
  constexpr std::size_t kQuad = kRecordsBelow[kQuads];
  const std::size_t last = std::min(tree.nodes(kGroups), (p + 1) * kWidth);
  for (std::size_t c = 0; c < 3; ++c) {
    double parent = 0;
    for (std::size_t g = p * kWidth; g < last; ++g) {
      const double* below = values(g) + c * kWidth;
      double whole = 0;
      for (std::size_t k = g * kQuad; k < (g + 1) * kQuad; ++k, below += kQuad) {
        const double quad = ((below[0] + below[1]) + below[2]) + below[3];
        sums_[kQuads][(k / kWidth * 3 + c) * kWidth + k % kWidth] = quad;
        whole += quad;
      }
      sums_[kGroups][(p * 3 + c) * kWidth + g % kWidth] = whole;
      parent += whole;
    }
    sums_[kParents][(p / kWidth * 3 + c) * kWidth + p % kWidth] = parent;
  }
}

}  // namespace psf::filter::engine
