// FLANN and brute force find the same neighbours, and those that the definition asks for.
#include <algorithm>
#include <limits>

#include "catch.h"
#include "core/parallel.h"
#include "points.h"
#include "search/brute_force.h"
#include "search/index.h"

namespace psf {
namespace {

using search::BruteForce;
using search::Index;
using search::Neighbor;
using tests::Points;

std::vector<Neighbor> sorted(std::vector<Neighbor> found) {
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.index < b.index; });
  return found;
}

// Every stride-th point and some places between and outside as centres. Returns how many pairs were
// found.
std::size_t compare(const tests::PointSet& set, std::size_t stride) {
  const Index index(set.points);
  const BruteForce brute(set.points);
  Points centers;
  for (std::size_t k = 0; k < set.points.size(); k += stride) {
    centers.push_back(set.points[k]);
    centers.push_back((set.points[k] + set.points[(k * 7 + 1) % set.points.size()]) * 0.5f);
  }
  centers.push_back(centers.front() + Vec3(1, 0, 0));
  std::vector<Neighbor> a, b;
  std::size_t pairs = 0, wrong = 0;
  for (const Vec3& center : centers) {
    for (const float r : set.radii) {
      index.within(center, r * r, a);
      brute.within(center, r * r, b);
      wrong += sorted(a) == b ? 0u : 1u;
      pairs += b.size();
    }
    for (const std::size_t k : {1u, 5u, 40u}) {
      index.nearest(center, k, a);
      brute.nearest(center, k, b);
      wrong += a == b ? 0u : 1u;
    }
  }
  CHECK(wrong == 0);
  return pairs;
}

TEST_CASE("FLANN and brute force find the same neighbours") {
  for (const std::size_t count : {1u, 2u, 3u, 10u, 11u, 100u, 1000u}) {
    for (const tests::PointSet& set : tests::point_sets(count)) {
      INFO(set.name << ", " << count << " points");
      CHECK(compare(set, 1 + count / 100) > 0);
    }
  }
}

TEST_CASE("FLANN and brute force find the same neighbours among 100,000 points") {
  for (const tests::PointSet& set : tests::point_sets(100'000)) {
    INFO(set.name);
    CHECK(compare(set, 20'000) > 0);
  }
}

TEST_CASE("FLANN and brute force find the same neighbours, many queries", "[.][long]") {
  for (const tests::PointSet& set : tests::point_sets(100'000)) {
    INFO(set.name);
    CHECK(compare(set, 2000) > 0);
  }
}

TEST_CASE("Who lies on the sphere is no neighbour") {
  const Points points = {{0, 0, 0}, {3, 4, 0},          {0, 0, 5},
                         {0, 3, 4}, {4.9999995f, 0, 0}, {5.0000005f, 0, 0}};
  const Index index(points);
  std::vector<Neighbor> found;
  index.within(Vec3(0, 0, 0), 25, found);
  REQUIRE(sorted(found).size() == 2);
  CHECK(sorted(found)[0] == Neighbor{0, 0});
  CHECK(sorted(found)[1].index == 4);
}

TEST_CASE("A ball without radius is empty, an infinite one holds all") {
  const Points points = {{1, 2, 3}, {1, 2, 3}, {4, 5, 6}};
  std::vector<Neighbor> found = {{7, 7}};
  for (const float r_sq : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    Index(points).within(points[0], r_sq, found);
    CHECK(found.empty());
    BruteForce(points).within(points[0], r_sq, found);
    CHECK(found.empty());
  }
  Index(points).within(points[0], std::numeric_limits<float>::infinity(), found);
  CHECK(found.size() == 3);
}

TEST_CASE("No points, no neighbours") {
  std::vector<Neighbor> found = {{7, 7}};
  Index(Points()).within(Vec3(0, 0, 0), 1, found);
  CHECK(found.empty());
  Index(Points()).nearest(Vec3(0, 0, 0), 3, found);
  CHECK(found.empty());
}

TEST_CASE("The nearest are in order, ties by the lower index, and no more than there are") {
  const Points points = {{2, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}};
  std::vector<Neighbor> found;
  Index(points).nearest(Vec3(0, 0, 0), 3, found);
  CHECK(found == std::vector<Neighbor>{{1, 1}, {2, 1}, {3, 1}});
  Index(points).nearest(Vec3(0, 0, 0), 9, found);
  CHECK(found.size() == 5);
  CHECK(found.back() == Neighbor{0, 4});
}

TEST_CASE("One index answers many threads at once as it answers one") {
  const Points points = tests::uniform_points(5000, 1, 9);
  const Index index(points);
  const auto ask = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    std::vector<std::vector<Neighbor>> all(points.size());
    core::parallel_for(points.size(), 100, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) index.within(points[k], 0.01f, all[k]);
    });
    return all;
  };
  CHECK(ask(1) == ask(4));
}

}  // namespace
}  // namespace psf
