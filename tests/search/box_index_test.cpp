// The index over boxes finds the boxes that a look at each finds.
#include "search/box_index.h"

#include <limits>

#include "catch.h"
#include "points.h"
#include "search/ball.h"

namespace psf {
namespace {

using search::Box;
using search::BoxIndex;
using tests::Points;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The squared gap along each axis, summed in the order of the axes.
float squared_gap(const Box& a, const Box& b) {
  float sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    float gap = 0;
    if (a.low[axis] > b.high[axis]) gap = a.low[axis] - b.high[axis];
    if (b.low[axis] > a.high[axis]) gap = b.low[axis] - a.high[axis];
    sum += gap * gap;
  }
  return sum;
}

std::vector<std::uint32_t> by_looking(const std::vector<Box>& boxes, const Box& box, float r_sq) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t k = 0; k < boxes.size(); ++k) {
    if (squared_gap(box, boxes[k]) < r_sq) found.push_back(k);
  }
  return found;
}

// From each point to where a side of a random share of `size` leads, down to none.
std::vector<Box> boxes_at(const Points& points, float size, std::uint32_t seed) {
  const Points sides = tests::uniform_points(points.size(), 1, seed);
  std::vector<Box> boxes;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const float scale = k % 5 == 0 ? 0 : k % 11 == 0 ? 20 * size : size * sides[k].x * sides[k].x;
    boxes.push_back({points[k], points[k] + sides[k] * scale});
  }
  return boxes;
}

// Returns how many boxes were found.
std::size_t check(const std::vector<Box>& boxes, const std::vector<Box>& queries,
                  const std::vector<float>& radii) {
  const BoxIndex index(boxes);
  std::vector<std::uint32_t> found = {7, 7, 7};
  std::size_t wrong = 0, total = 0;
  for (const Box& query : queries) {
    for (const float r : radii) {
      index.within(query, r * r, found);
      const std::vector<std::uint32_t> expected = by_looking(boxes, query, r * r);
      wrong += found == expected ? 0u : 1u;
      total += expected.size();
    }
  }
  CHECK(wrong == 0);
  return total;
}

TEST_CASE("A look at each box and the index agree") {
  for (const std::size_t count : {1u, 2u, 31u, 32u, 33u, 100u, 1000u}) {
    for (const tests::PointSet& set : tests::point_sets(count)) {
      if (set.name == "beyond FLANN's reach") continue;  // boxes must be finite
      std::vector<float> radii = set.radii;
      radii.insert(radii.end(), {0, kInfinity});
      for (const float size : {0.0f, set.radii[0], set.radii.back()}) {
        const std::vector<Box> boxes = boxes_at(set.points, size, 3);
        std::vector<Box> queries;
        for (std::size_t k = 0; k < count; k += 1 + count / 40) {
          queries.push_back(boxes[k]);
          queries.push_back({set.points[k], set.points[k]});
        }
        INFO(set.name << ", " << count << " boxes, size " << size);
        CHECK(check(boxes, queries, radii) > 0);
      }
    }
  }
}

TEST_CASE("A few huge boxes among many small ones are found") {
  std::vector<Box> boxes = boxes_at(tests::uniform_points(2000, 1, 5), 0.01f, 6);
  boxes[100] = {Vec3(-5, -5, -5), Vec3(-4, 5, 5)};
  boxes[900] = {Vec3(-1e18f, -1e18f, 3), Vec3(1e18f, 1e18f, 3)};
  boxes[1500] = {Vec3(1e18f, 0, 0), Vec3(1e18f, 1, 1)};
  const std::vector<Box> queries = {
      boxes[100], boxes[900], boxes[1500], boxes[7], {Vec3(-3, 0, 0), Vec3(-3, 0, 0)}};
  CHECK(check(boxes, queries, {0, 1e-3f, 0.1f, 1.5f, 4, 1e18f, 2e18f, kInfinity}) > 2000);
}

TEST_CASE("Who is at the distance itself is not within") {
  const BoxIndex index({{Vec3(3, 4, 0), Vec3(9, 9, 9)}, {Vec3(-1, -1, -5), Vec3(1, 1, -5)}});
  std::vector<std::uint32_t> found;
  const Box origin{Vec3(0, 0, 0), Vec3(0, 0, 0)};
  index.within(origin, 25, found);
  CHECK(found.empty());
  index.within(origin, 25.000002f, found);
  CHECK(found == std::vector<std::uint32_t>{0, 1});
}

TEST_CASE("Boxes that touch or overlap are within any radius but 0") {
  const BoxIndex index({{Vec3(0, 0, 0), Vec3(1, 1, 1)}, {Vec3(1, 1, 1), Vec3(1, 1, 1)}});
  std::vector<std::uint32_t> found;
  const Box box{Vec3(1, 0, 0), Vec3(2, 1, 1)};
  index.within(box, 1e-38f, found);
  CHECK(found == std::vector<std::uint32_t>{0, 1});
  index.within(box, 0, found);
  CHECK(found.empty());
}

TEST_CASE("No boxes, nothing found") {
  std::vector<std::uint32_t> found = {7};
  BoxIndex({}).within({Vec3(0, 0, 0), Vec3(1, 1, 1)}, kInfinity, found);
  CHECK(found.empty());
}

// What the fast engine relies on: rounding never makes a gap longer than a distance it bounds.
TEST_CASE("The gap of two boxes is at most the distance of any two points in them") {
  for (const tests::PointSet& set : tests::point_sets(400)) {
    std::size_t wrong = 0;
    for (std::size_t k = 0; k + 12 <= set.points.size(); k += 6) {
      const auto box_of = [&](std::size_t first) {
        Box box{set.points[first], set.points[first]};
        for (std::size_t i = first; i < first + 6; ++i) {
          for (int axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min(box.low[axis], set.points[i][axis]);
            box.high[axis] = std::max(box.high[axis], set.points[i][axis]);
          }
        }
        return box;
      };
      const float gap_sq = search::gap_sq(box_of(k), box_of(k + 6));
      for (std::size_t i = k; i < k + 6; ++i) {
        for (std::size_t j = k + 6; j < k + 12; ++j) {
          wrong += search::distance_sq(set.points[i], set.points[j]) < gap_sq ? 1u : 0u;
          wrong += search::distance_sq(set.points[j], set.points[i]) < gap_sq ? 1u : 0u;
        }
      }
    }
    INFO(set.name);
    CHECK(wrong == 0);
  }
}

}  // namespace
}  // namespace psf
