// The compact order: every point once, near points in one group, the same for any threads.
#include "search/compact_order.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "catch.h"
#include "core/parallel.h"
#include "points.h"

namespace psf {
namespace {

using search::compact_order;
using tests::Points;
using Numbers = std::vector<std::uint32_t>;

Numbers all_of(const Points& points) {
  Numbers all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

// The sum of the sides of the box of each run of `length`, in the mean; the last run is left out.
double mean_sides(const Points& points, const Numbers& order, std::size_t length) {
  double total = 0;
  const std::size_t runs = order.size() / length;
  for (std::size_t run = 0; run < runs; ++run) {
    for (int axis = 0; axis < 3; ++axis) {
      float low = points[order[run * length]][axis], high = low;
      for (std::size_t k = run * length; k < (run + 1) * length; ++k) {
        low = std::min(low, points[order[k]][axis]);
        high = std::max(high, points[order[k]][axis]);
      }
      total += double{high} - double{low};
    }
  }
  return total / static_cast<double>(runs);
}

// On a surface, as first hits are.
Points on_a_square(std::size_t count) {
  Points points = tests::uniform_points(count, 1, 12);
  for (Vec3& p : points) p.y = 0;
  return points;
}

TEST_CASE("The order has every chosen point once, whatever their number and places") {
  for (const std::size_t count :
       {1u, 2u, 15u, 16u, 17u, 255u, 256u, 257u, 4095u, 4096u, 4097u, 16'385u, 70'001u}) {
    for (const tests::PointSet& set : tests::point_sets(count)) {
      INFO(set.name << ", " << count << " points");
      Numbers order = compact_order(set.points, all_of(set.points));
      std::sort(order.begin(), order.end());
      CHECK(order == all_of(set.points));
    }
  }
}

TEST_CASE("The order is of the chosen points alone, in whatever order they are given") {
  const Points points = tests::uniform_points(5000, 1, 10);
  Numbers chosen;
  for (std::uint32_t k = 1; k < points.size(); k += 2) chosen.push_back(k);
  const Numbers order = compact_order(points, chosen);
  Numbers sorted = order;
  std::sort(sorted.begin(), sorted.end());
  CHECK(sorted == chosen);
  std::reverse(chosen.begin(), chosen.end());
  CHECK(compact_order(points, chosen).size() == order.size());
  CHECK(compact_order(points, {}).empty());
}

TEST_CASE("The order is the same for any number of threads") {
  for (const std::size_t count : {5000u, 300'000u}) {
    for (const Points& points :
         {tests::uniform_points(count, 1, 11), tests::lattice_points(count, 3)}) {
      const auto with_threads = [&](std::size_t threads) {
        const core::ThreadLimit limit(threads);
        return compact_order(points, all_of(points));
      };
      const Numbers one = with_threads(1);
      CHECK(one == with_threads(2));
      CHECK(one == with_threads(3));
    }
  }
}

// A run of M of N points fills a share M / N of the space: of a cube or a square of that size, if
// it is compact. Cuts into four leave some runs two or four times as long as wide.
TEST_CASE("Runs of a group, of a group of groups and so on are compact") {
  for (const std::size_t count : {4096u, 65'536u, 100'000u}) {
    const Points cube = tests::uniform_points(count, 1, 13), square = on_a_square(count);
    const Numbers in_cube = compact_order(cube, all_of(cube));
    const Numbers on_square = compact_order(square, all_of(square));
    for (std::size_t length = search::kGroup; length * search::kGroup <= count;
         length *= search::kGroup) {
      const double share = static_cast<double>(length) / static_cast<double>(count);
      INFO(length << " of " << count);
      CHECK(mean_sides(cube, in_cube, length) < 1.3 * 3 * std::cbrt(share));
      CHECK(mean_sides(square, on_square, length) < 1.3 * 2 * std::sqrt(share));
    }
  }
}

TEST_CASE("Clumps far apart are not mixed in a group") {
  Points points;
  for (std::uint32_t clump = 0; clump < 64; ++clump) {
    const Vec3 at(static_cast<float>(clump % 4), static_cast<float>(clump / 4 % 4),
                  static_cast<float>(clump / 16));
    for (const Vec3& p : tests::uniform_points(256, 0.01f, clump, at)) points.push_back(p);
  }
  const Numbers order = compact_order(points, all_of(points));
  CHECK(mean_sides(points, order, 256) < 0.03);
  CHECK(mean_sides(points, order, 16) < 0.02);
}

TEST_CASE("Where a side is no finite number the order stays") {
  const Points extreme = {{3e38f, 0, 0}, {-3e38f, 0, 0}, {0, 0, 0}};
  CHECK(compact_order(extreme, all_of(extreme)) == all_of(extreme));
}

}  // namespace
}  // namespace psf
