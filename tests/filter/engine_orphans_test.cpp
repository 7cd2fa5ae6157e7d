// Orphans of the fast engine adopt what those of the plain one do.
#include <cmath>
#include <cstdint>
#include <limits>

#include "catch.h"
#include "engine_case.h"
#include "search/points.h"

namespace psf {
namespace {

using Kind = filter::EngineKind;
using tests::EngineCase;

// Contributions tell which sources were adopted. Returns how many orphans there were.
std::uint64_t check_orphans(const EngineCase& c) {
  const filter::Estimates fast = c.filtered(Kind::flann);
  CHECK(tests::difference(fast, c.filtered(Kind::plain)) == "");
  CHECK(tests::difference(fast, c.filtered(Kind::brute)) == "");
  return fast.statistics.orphans;
}

TEST_CASE("Orphans agree among random sources, few of which pass") {
  for (const std::size_t count : {2u, 17u, 250u, 1500u}) {
    for (const unsigned terms : {0u, 7u, 64u, 255u}) {
      for (const float r : {0.0f, 1e-25f, 0.01f, 0.1f}) {
        EngineCase c(count, static_cast<std::uint32_t>(count) + terms, 0.5);
        c.radius.assign(count, r);
        c.parameters.weights = tests::terms_of(terms);
        INFO(count << " records, terms " << terms << ", radius " << r);
        check_orphans(c);
      }
    }
  }
}

// As on surfaces, what is near is alike, so that many nodes of the tree are refused as a whole.
TEST_CASE("Orphans agree where whole regions are refused") {
  constexpr std::size_t kCount = 3000;
  EngineCase c(kCount, 11, 0.8);
  c.radius.assign(kCount, 0);
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec3 x = c.set.position[i];
    const float turn = std::floor(4 * x.x);
    c.set.normal[i] = Vec3(std::cos(turn), std::sin(turn), 0);
    c.set.direction[i] = Vec3(0, std::cos(2 * x.z), std::sin(2 * x.z));
    c.set.reflectance[i] = Rgb(0.5f * x.y, 0.5f, x.z);
    c.set.visibility[i] = x.z < 0.3f ? 0x80000000u : x.z < 0.6f ? 0u : 1u;
    c.set.material[i] = static_cast<std::uint32_t>(std::floor(3 * x.x));
    // A region without a source.
    if (x.x + x.y + x.z < 0.8f) c.set.flags[i] = filter::kHasVertex;
  }
  for (const unsigned terms : {1u, 2u, 4u, 32u, 64u, 71u, 103u, 255u}) {
    c.parameters.weights = tests::terms_of(terms);
    INFO("terms " << terms);
    CHECK(check_orphans(c) > kCount / 2);
  }
}

TEST_CASE("Orphans agree on ties, where the lower record goes first") {
  for (const std::size_t count : {40u, 700u}) {
    EngineCase c(count, 3, 0.5);
    c.set.position = tests::lattice_points(count, 4);
    c.radius.assign(count, 0);
    c.parameters.weights = tests::terms_of(4);
    CHECK(check_orphans(c) > count / 4);
    c.set.position.assign(count, Vec3(0.1f, 0.2f, 0.3f));
    CHECK(check_orphans(c) > count / 4);
  }
}

TEST_CASE("Orphans agree where one source passes, the last or the farthest, or none") {
  for (const std::size_t count : {18u, 300u, 2000u}) {
    for (const std::size_t chosen : {std::size_t{1}, count / 2, count - 1, count}) {
      EngineCase c(count, 5);
      c.set.flags.assign(count, filter::kHasVertex | filter::kShaded);
      c.set.material.assign(count, 1);
      for (std::size_t i = 0; i < count; i += 9) {
        c.set.flags[i] = filter::kHasVertex;
        c.set.material[i] = 2;
      }
      if (chosen < count) {
        c.set.flags[chosen] = filter::kHasVertex | filter::kShaded;
        c.set.material[chosen] = 2;
        c.set.position[chosen] = Vec3(1e5f, 0, 0);
      }
      c.parameters.weights = tests::terms_of(64);
      c.radius.assign(count, 0.01f);
      INFO(count << " records, " << chosen << " passes");
      CHECK(check_orphans(c) > 0);
      const filter::Statistics counts = c.filtered(Kind::flann).statistics;
      CHECK(counts.orphans_unmatched == (chosen < count ? 0 : counts.orphans));
    }
  }
}

TEST_CASE("Orphans agree at any scale") {
  for (const tests::PointSet& points : tests::point_sets(300)) {
    for (const float r : {0.0f, points.radii.front()}) {
      EngineCase c(300, 6, 0.6);
      c.set.position = points.points;
      c.radius.assign(300, r);
      c.parameters.weights = tests::terms_of(5);
      INFO(points.name << ", radius " << r);
      check_orphans(c);
    }
  }
}

TEST_CASE("Orphans of infinite reach agree") {
  EngineCase c(200, 7, 0.5);
  c.radius.assign(200, std::numeric_limits<float>::infinity());
  c.set.visibility.assign(200, 1);
  for (std::size_t i = 0; i < 200; i += 2) {
    c.set.flags[i] = filter::kHasVertex;
    c.set.visibility[i] = 2;
  }
  c.parameters.weights = tests::terms_of(4);
  CHECK(check_orphans(c) == 100);
}

}  // namespace
}  // namespace psf
