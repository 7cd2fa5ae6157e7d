#include "filter/engine/tree.h"

#include <algorithm>

#include "core/parallel.h"
#include "filter/engine/kernel.h"

namespace psf::filter::engine {
namespace {

constexpr std::size_t kGrain = 16;  // families of nodes a range

}  // namespace

Tree::Tree(const Records& records, std::vector<std::uint32_t> order, const ColumnPlan& plan)
    : plan_(plan), order_(std::move(order)) {
  std::size_t nodes = size();
  for (Level& level : levels_) {
    level.nodes = nodes = core::range_count(nodes, kWidth);
    const std::size_t families = core::range_count(nodes, kWidth);
    level.bounds = core::Buffer<float>(families * 2 * plan_.count * kWidth);
    level.sums = core::Buffer<double>(families * 3 * kWidth);
  }
  leaves_ = core::Buffer<float>(levels_[0].nodes * plan_.count * kWidth);
  values_ = core::Buffer<double>(levels_[0].nodes * 3 * kWidth);

  const std::span<const std::uint32_t> all = order_;
  const std::size_t families = core::range_count(levels_[0].nodes, kWidth);
  core::parallel_for(families, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin * kWidth; g < std::min(levels_[0].nodes, end * kWidth); ++g) {
      const std::size_t first = g * kWidth;
      plan_.gather(records, all.subspan(first, std::min(kWidth, size() - first)),
                   &leaves_[g * plan_.count * kWidth]);
    }
    for (std::size_t family = begin; family < end; ++family) bound_family(0, family);
  });
  for (std::size_t k = 1; k < kLevels; ++k) {
    for (std::size_t family = 0; family < core::range_count(levels_[k].nodes, kWidth); ++family) {
      bound_family(k, family);
    }
  }
}

// Bounds of the nodes of a family from what is below them: 16 records or 16 children. Places
// without a node get the bounds of the last one.
void Tree::bound_family(std::size_t k, std::size_t family) {
  Level& level = levels_[k];
  const std::size_t rows = plan_.count * kWidth;
  float* low = &level.bounds[family * 2 * rows];
  for (std::size_t place = 0; place < kWidth; ++place) {
    const std::size_t node = std::min(family * kWidth + place, level.nodes - 1);
    const float* lows = k == 0 ? group(node) : &levels_[k - 1].bounds[node * 2 * rows];
    const float* highs = k == 0 ? lows : lows + rows;
    extremes(plan_, lows, highs, low + place, low + rows + place);
  }
}

search::Box Tree::box(std::size_t k, std::size_t node) const {
  const float* low = bounds(k, node / kWidth) + node % kWidth;
  const float* high = low + plan_.count * kWidth;
  return {{low[0], low[kWidth], low[2 * kWidth]}, {high[0], high[kWidth], high[2 * kWidth]}};
}

void Tree::set_values(std::span<const Rgb> values, std::span<const float> area) {
  const std::size_t families = core::range_count(levels_[0].nodes, kWidth);
  core::parallel_for(families, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin * kWidth; g < std::min(levels_[0].nodes, end * kWidth); ++g) {
      double* out = &values_[g * 3 * kWidth];
      for (std::size_t k = 0; k < kWidth; ++k) {
        const std::size_t p = g * kWidth + k;
        const std::uint32_t j = order_[std::min(p, size() - 1)];
        const double weight = p >= size() ? 0 : area.empty() ? 1 : double{area[j]};
        out[k] = weight * double{values[j].x};
        out[kWidth + k] = weight * double{values[j].y};
        out[2 * kWidth + k] = weight * double{values[j].z};
      }
    }
    for (std::size_t family = begin; family < end; ++family) sum_family(0, family);
  });
  for (std::size_t k = 1; k < kLevels; ++k) {
    for (std::size_t family = 0; family < core::range_count(levels_[k].nodes, kWidth); ++family) {
      sum_family(k, family);
    }
  }
}

void Tree::sum_family(std::size_t k, std::size_t family) {
  Level& level = levels_[k];
  for (std::size_t node = family * kWidth; node < std::min(level.nodes, (family + 1) * kWidth);
       ++node) {
    const double* below = k == 0 ? this->values(node) : &levels_[k - 1].sums[node * 3 * kWidth];
    const std::size_t children =
        k == 0 ? kWidth : std::min(kWidth, levels_[k - 1].nodes - node * kWidth);
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t place = 0; place < children; ++place) sum += below[c * kWidth + place];
      level.sums[(family * 3 + c) * kWidth + node % kWidth] = sum;
    }
  }
}

}  // namespace psf::filter::engine
