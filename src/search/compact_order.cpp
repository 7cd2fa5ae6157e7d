#include "search/compact_order.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "core/buffer.h"
#include "core/parallel.h"

namespace psf::search {
namespace {

// Parts a side is cut into: nearly as compact as halves, for half as many sorts.
constexpr std::size_t kParts = 4;
// Points that fit the nearest caches: all segments of one size are cut by one sort.
constexpr std::size_t kRun = 4096;
// Up to here keys of 32 bits have enough room for the coordinate beside the place.
constexpr std::size_t kSmallKeys = std::size_t{1} << 20;

struct Point {
  float x[3];
  std::uint32_t number;
};
using Points = std::span<Point>;

struct Side {
  std::size_t axis = 0;
  float low = 0, length = 0;
};
Side longest_side(std::span<const Point> points) {
  float low[3] = {points[0].x[0], points[0].x[1], points[0].x[2]};
  float high[3] = {low[0], low[1], low[2]};
  for (const Point& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p.x[axis]);
      high[axis] = std::max(high[axis], p.x[axis]);
    }
  }
  std::size_t axis = high[1] - low[1] > high[0] - low[0] ? 1 : 0;
  if (high[2] - low[2] > high[axis] - low[axis]) axis = 2;
  return {axis, low[axis], high[axis] - low[axis]};
}

// `from` to `to`, every segment of `segment` points sorted along its longest side: by keys of the
// segment, the coordinate as finely as there is room for, and the place.
template <class Key>
void sort_segments(Points from, Points to, std::size_t segment) {
  const std::size_t segments = core::range_count(from.size(), segment);
  const auto place_bits = static_cast<unsigned>(std::bit_width(from.size() - 1));
  const auto segment_bits = static_cast<unsigned>(std::bit_width(segments - 1));
  const unsigned step_bits = std::min(24u, unsigned{sizeof(Key)} * 8 - place_bits - segment_bits);
  const float steps = static_cast<float>(std::uint32_t{1} << step_bits) * 0.999999f;
  core::Buffer<Key> keys(from.size());
  for (std::size_t s = 0; s < segments; ++s) {
    const std::size_t begin = s * segment, end = std::min(from.size(), begin + segment);
    const Side side = longest_side(from.subspan(begin, end - begin));
    // Where all are as good as equal, or the side is no finite float, the order stays.
    const bool is_measured = side.length > 1e-30f && side.length < 1e37f;
    const float scale = is_measured ? steps / side.length : 0;
    const Key first = static_cast<Key>(s) << (step_bits + place_bits);
    for (std::size_t k = begin; k < end; ++k) {
      const float along = is_measured ? (from[k].x[side.axis] - side.low) * scale : 0;
      const auto step = static_cast<std::int32_t>(along);
      keys[k] = first | static_cast<Key>(step) << place_bits | static_cast<Key>(k);
    }
  }
  hwy::Sorter()(keys.begin(), keys.size(), hwy::SortAscending());
  const Key place_mask = (Key{1} << place_bits) - 1;
  for (std::size_t k = 0; k < to.size(); ++k) to[k] = from[keys[k] & place_mask];
}

// The largest of kGroup, kGroup^2 ... of which there are several in `count`: where it is cut,
// groups of groups stay whole.
std::size_t unit_of(std::size_t count) {
  std::size_t unit = kGroup;
  while (unit * kGroup < count) unit *= kGroup;
  return unit;
}

// Leaves the result in `points`; `other` is as long.
void cut_run(Points points, Points other) {
  Points from = points, to = other;
  for (std::size_t segment = kRun; segment > kGroup; segment /= kParts) {
    if (points.size() <= segment / kParts) continue;  // each is one part
    sort_segments<std::uint32_t>(from, to, segment);
    std::swap(from, to);
  }
  if (from.data() != points.data()) std::copy(from.begin(), from.end(), points.begin());
}

void cut(Points points, Points other) {
  if (points.size() <= kRun) return cut_run(points, other);
  if (points.size() <= kSmallKeys) {
    sort_segments<std::uint32_t>(points, other, points.size());
  } else {
    sort_segments<std::uint64_t>(points, other, points.size());
  }
  const std::size_t unit = unit_of(points.size());
  const std::size_t part = core::range_count(core::range_count(points.size(), unit), kParts) * unit;
  core::parallel_for(points.size(), part, [&](std::size_t begin, std::size_t end) {
    std::copy(&other[begin], &other[begin] + (end - begin), &points[begin]);
    cut(points.subspan(begin, end - begin), other.subspan(begin, end - begin));
  });
}

}  // namespace

std::vector<std::uint32_t> compact_order(std::span<const Vec3> points,
                                         std::span<const std::uint32_t> chosen) {
  if (chosen.empty()) return {};
  core::Buffer<Point> copies(chosen.size()), other(chosen.size());
  core::parallel_for(chosen.size(), kRun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3& x = points[chosen[k]];
      copies[k] = {{x.x, x.y, x.z}, chosen[k]};
    }
  });
  cut({copies.begin(), copies.end()}, {other.begin(), other.end()});
  std::vector<std::uint32_t> order(chosen.size());
  std::transform(copies.begin(), copies.end(), order.begin(),
                 [](const Point& p) { return p.number; });
  return order;
}

}  // namespace psf::search
