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

struct Box {
  float low[3], high[3];

  void add(const float (&a)[3], const float (&b)[3]) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], a[axis]);
      high[axis] = std::max(high[axis], b[axis]);
    }
  }
};
Box box_of(std::span<const Point> points) {
  const auto& x = points[0].x;
  Box box{{x[0], x[1], x[2]}, {x[0], x[1], x[2]}};
  for (const Point& p : points) box.add(p.x, p.x);
  return box;
}

// The coordinate along the longest side as one of 2^bits steps.
class Steps {
 public:
  Steps(const Box& box, unsigned bits) {
    for (std::size_t axis = 1; axis < 3; ++axis) {
      if (side(box, axis) > side(box, axis_)) axis_ = axis;
    }
    low_ = box.low[axis_];
    // Where all are as good as equal, or the side is no finite float, the order stays.
    const float length = side(box, axis_);
    const float steps = static_cast<float>(std::uint32_t{1} << bits) * 0.999999f;
    if (length > 1e-30f && length < 1e37f) scale_ = steps / length;
  }
  [[nodiscard]] std::uint32_t of(const Point& p) const {
    if (scale_ == 0) return 0;
    return static_cast<std::uint32_t>(static_cast<std::int32_t>((p.x[axis_] - low_) * scale_));
  }

 private:
  static float side(const Box& box, std::size_t axis) { return box.high[axis] - box.low[axis]; }

  std::size_t axis_ = 0;
  float low_ = 0, scale_ = 0;
};

// Sorts points by keys: what comes first, the coordinate as finely as there is room for, the place.
template <class Key>
struct Keys {
  Keys(std::size_t points, std::size_t segments)
      : place_bits(static_cast<unsigned>(std::bit_width(points - 1))),
        step_bits(std::min(24u, unsigned{sizeof(Key)} * 8 - place_bits -
                                    static_cast<unsigned>(std::bit_width(segments - 1)))),
        keys(points) {}

  void set(std::size_t place, std::size_t segment, std::uint32_t step) {
    const Key first = static_cast<Key>(segment) << step_bits | static_cast<Key>(step);
    keys[place] = first << place_bits | static_cast<Key>(place);
  }
  void sort() { hwy::Sorter()(keys.begin(), keys.size(), hwy::SortAscending()); }
  [[nodiscard]] std::size_t place(std::size_t k) const {
    return keys[k] & ((Key{1} << place_bits) - 1);
  }

  unsigned place_bits, step_bits;
  core::Buffer<Key> keys;
};

// `from` to `to`, sorted along the longest side.
template <class Key>
void sort_all(Points from, Points to) {
  std::vector<Box> boxes(core::range_count(from.size(), kRun));
  core::parallel_for(from.size(), kRun, [&](std::size_t begin, std::size_t end) {
    boxes[begin / kRun] = box_of(from.subspan(begin, end - begin));
  });
  for (const Box& box : boxes) boxes[0].add(box.low, box.high);
  Keys<Key> keys(from.size(), 1);
  const Steps steps(boxes[0], keys.step_bits);
  core::parallel_for(from.size(), kRun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) keys.set(k, 0, steps.of(from[k]));
  });
  keys.sort();
  core::parallel_for(to.size(), kRun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) to[k] = from[keys.place(k)];
  });
}

// Sorts each segment of `segment` points of a run along the longest side of the segment's box.
void sort_segments(Points from, Points to, std::size_t segment) {
  const std::size_t segments = core::range_count(from.size(), segment);
  Keys<std::uint32_t> keys(from.size(), segments);
  for (std::size_t s = 0; s < segments; ++s) {
    const std::size_t begin = s * segment, end = std::min(from.size(), begin + segment);
    const Steps steps(box_of(from.subspan(begin, end - begin)), keys.step_bits);
    for (std::size_t k = begin; k < end; ++k) keys.set(k, s, steps.of(from[k]));
  }
  keys.sort();
  for (std::size_t k = 0; k < to.size(); ++k) to[k] = from[keys.place(k)];
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
    sort_segments(from, to, segment);
    std::swap(from, to);
  }
  if (from.data() != points.data()) std::copy(from.begin(), from.end(), points.begin());
}

void cut(Points points, Points other) {
  if (points.size() <= kRun) return cut_run(points, other);
  if (points.size() <= kSmallKeys) {
    sort_all<std::uint32_t>(points, other);
  } else {
    sort_all<std::uint64_t>(points, other);
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
  core::parallel_for(order.size(), kRun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) order[k] = copies[k].number;
  });
  return order;
}

}  // namespace psf::search
