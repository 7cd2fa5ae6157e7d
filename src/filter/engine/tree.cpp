#include "filter/engine/tree.h"

#include "core/parallel.h"
#include "filter/engine/kernel.h"

namespace psf::filter::engine {
namespace {

constexpr std::size_t kGrain = 16;  // parents a range
constexpr std::size_t kQuad = kRecordsBelow[kQuads];

}  // namespace

Tree::Tree(const Records& records, std::vector<std::uint32_t> order, const ColumnPlan& plan)
    : plan_(plan), order_(std::move(order)) {
  for (const LevelName level : {kQuads, kGroups, kParents}) {
    Level& l = levels_[level];
    l.nodes = core::range_count(size(), kRecordsBelow[level]);
    const std::size_t families = core::range_count(l.nodes, kWidth);
    l.bounds = core::Buffer<float>(families * 2 * columns(level) * kWidth);
  }
  leaves_ = core::Buffer<float>(nodes(kGroups) * plan_.count * kWidth);

  const std::span<const std::uint32_t> all = order_;
  core::parallel_for(nodes(kParents), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin * kWidth; g < std::min(nodes(kGroups), end * kWidth); ++g) {
      plan_.gather(records, all.subspan(g * kWidth, size_of(kGroups, g)),
                   &leaves_[g * plan_.count * kWidth]);
      bound_quads(g);
      bound_group(g);
    }
  });
  for (const LevelName level : {kQuads, kGroups}) fill_last_family(level);
  for (std::size_t p = 0; p < nodes(kParents); ++p) bound_parent(p);
  fill_last_family(kParents);
}

// A group is filled up with its last record, so all its four quads have bounds.
void Tree::bound_quads(std::size_t g) {
  constexpr std::size_t kInGroup = kWidth / kQuad;
  float* low = &levels_[kQuads].bounds[g / kInGroup * 6 * kWidth] + g % kInGroup * kQuad;
  float* high = low + 3 * kWidth;
  for (std::size_t c = 0; c < 3; ++c) {
    const float* x = group(g) + c * kWidth;
    for (std::size_t quad = 0; quad < kInGroup; ++quad, x += kQuad) {
      low[c * kWidth + quad] = std::min(std::min(x[0], x[1]), std::min(x[2], x[3]));
      high[c * kWidth + quad] = std::max(std::max(x[0], x[1]), std::max(x[2], x[3]));
    }
  }
}

void Tree::bound_group(std::size_t g) {
  float* low = &levels_[kGroups].bounds[g / kWidth * 2 * plan_.count * kWidth] + g % kWidth;
  extremes(plan_, plan_.count, group(g), group(g), low, low + plan_.count * kWidth);
}

void Tree::bound_parent(std::size_t p) {
  const float* lows = bounds(kGroups, p);
  const std::size_t rows = plan_.count * kWidth;
  float* low = &levels_[kParents].bounds[p / kWidth * 2 * rows] + p % kWidth;
  extremes(plan_, plan_.count, lows, lows + rows, low, low + rows);
}

void Tree::fill_last_family(LevelName level) {
  const std::size_t filled = (levels_[level].nodes - 1) % kWidth + 1;
  // Quads are bounded four at a time, the last ones from repeated records.
  const std::size_t first = level == kQuads ? core::range_count(filled, kQuad) * kQuad : filled;
  float* row =
      &levels_[level].bounds[(levels_[level].nodes - 1) / kWidth * 2 * columns(level) * kWidth];
  for (std::size_t c = 0; c < 2 * columns(level); ++c, row += kWidth) {
    std::fill(row + first, row + kWidth, row[first - 1]);
  }
}

bool Tree::all_within(float largest) const {
  const std::size_t families = core::range_count(nodes(kGroups), kWidth);
  for (std::size_t c = 0; c < plan_.count; ++c) {
    if (plan_.is_integer(c) || c == plan_.hit_distance || c == plan_.lobe_width) continue;
    for (std::size_t family = 0; family < families; ++family) {
      const float* low = bounds(kGroups, family) + c * kWidth;
      const float* high = low + plan_.count * kWidth;
      for (std::size_t k = 0; k < kWidth; ++k) {
        if (!(low[k] >= -largest && high[k] <= largest)) return false;
      }
    }
  }
  return true;
}

search::Box Tree::box(LevelName level, std::size_t node) const {
  const float* low = bounds(level, node / kWidth) + node % kWidth;
  const float* high = low + columns(level) * kWidth;
  return {{low[0], low[kWidth], low[2 * kWidth]}, {high[0], high[kWidth], high[2 * kWidth]}};
}

}  // namespace psf::filter::engine
