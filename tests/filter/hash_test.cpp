// The jittered grid: who shares a cell, how large cells are, and that accidents mix none.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "catch.h"
#include "estimator_case.h"
#include "filter/estimators/hash_cells.h"
#include "filter/estimators/hash_key.h"
#include "filter/weights.h"

namespace psf {
namespace {

using filter::CellKey;
using filter::Cells;
using filter::KeyMaker;
using tests::EstimatorRun;
using tests::RecordSet;

// One surface patch in the plane across `normal`, with points spread over side x side units.
RecordSet patch(std::size_t count, const Vec3& normal, float side, std::uint32_t seed) {
  RecordSet set(count);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const Vec3 u = (std::abs(normal.x) > 0.5f ? Vec3(0, 1, 0) : Vec3(1, 0, 0)).cross(normal);
  const Vec3 a = u.normalized(), b = normal.cross(a);
  for (std::size_t i = 0; i < count; ++i) {
    set.position[i] = a * (side * unit(random)) + b * (side * unit(random));
    set.normal[i] = normal;
    set.contribution[i] = Rgb(unit(random), 0, 0);
  }
  return set;
}

std::vector<CellKey> keys_of(const RecordSet& set, const filter::WeightTerms& terms, float r) {
  const KeyMaker maker(set.view(), terms, 1, 0);
  std::vector<CellKey> keys;
  for (std::uint32_t i = 0; i < set.size(); ++i) keys.push_back(maker(i, r, 0));
  return keys;
}

TEST_CASE("Equal keys are one cell, in the order of records, even if all hashes are equal") {
  const RecordSet set = tests::random_records(9000, 1, 0, {{30, 30, 0.05}});
  const std::vector<CellKey> keys = keys_of(set, tests::terms_of(3), 0.2f);
  const auto less = [](const CellKey& a, const CellKey& b) { return a.compare(b) < 0; };
  std::map<CellKey, std::vector<std::uint32_t>, decltype(less)> expected(less);
  for (std::uint32_t i = 0; i < keys.size(); ++i) expected[keys[i]].push_back(i);
  for (const std::uint64_t mask : {~0ull, 3ull << 62, 0ull}) {
    const Cells cells = filter::group_equal(keys, mask);
    REQUIRE(cells.count() == expected.size());
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < cells.count(); ++k) {
      const auto members = cells[k];
      wrong +=
          expected[keys[members[0]]] != std::vector<std::uint32_t>(members.begin(), members.end())
              ? 1u
              : 0u;
    }
    CHECK(wrong == 0);
    CHECK(expected.size() > 100);
    CHECK(expected.size() < keys.size() / 2);
  }
}

TEST_CASE("Two records of one cell pass every term, whatever the terms") {
  std::mt19937 random(3);
  std::normal_distribution<float> normal(0, 1);
  std::uniform_real_distribution<float> unit(0, 1);
  RecordSet set(3000);
  for (std::size_t i = 0; i < set.size(); ++i) {
    // Few directions and many near each of them, so that thresholds decide.
    const auto near = [&](std::size_t k) {
      Vec3 v = k % 3 == 0 ? Vec3(0, 1, 0) : k % 3 == 1 ? Vec3(0.6f, 0, 0.8f) : Vec3(-1, 0, 0);
      for (int axis = 0; axis < 3; ++axis) v[axis] += 0.15f * normal(random);
      return v.normalized();
    };
    set.normal[i] = near(i);
    set.direction[i] = near(i / 3);
    set.reflectance[i] = Rgb(0.1f * unit(random), 0.5f, 0.1f * unit(random));
    set.visibility[i] = random() % 2;
    set.material[i] = random() % 2;
    set.roughness[i] = i % 2 == 0 ? 1 : unit(random);
    set.hit_distance[i] = i % 5 == 0 ? std::numeric_limits<float>::infinity() : unit(random) * 9;
  }
  for (unsigned bits = 0; bits < 256; bits += bits == 0 ? 1 : bits) {
    for (const float strict : {0.0f, 0.5f, 1.0f}) {
      if ((bits & 16) != 0) continue;  // plane: refused
      filter::WeightTerms terms = tests::terms_of(bits);
      if (terms.normal) *terms.normal = strict;
      if (terms.direction) *terms.direction = strict == 1 ? 0.99f : strict;
      if (terms.reflectance) *terms.reflectance = 0.1f * strict;
      if (terms.hit_distance) *terms.hit_distance = 0.5f * strict;
      if (terms.gloss) *terms.gloss = strict == 1 ? 0.5f : 4 + strict;
      // A radius that holds all, so that the terms alone decide.
      const std::vector<CellKey> keys = keys_of(set, terms, 1e6f);
      const Cells cells = filter::group_equal(keys);
      const filter::Weights weights(set.view(), terms);
      std::size_t pairs = 0, refused = 0;
      for (std::size_t k = 0; k < cells.count(); ++k) {
        for (const std::uint32_t i : cells[k]) {
          for (const std::uint32_t j : cells[k]) {
            if (i == j) continue;
            ++pairs;
            refused += weights.pass(i, j, 1e6f) ? 0u : 1u;
          }
        }
      }
      INFO("terms " << bits << ", " << strict);
      CHECK(refused == 0);
      if (strict == 0.5f) CHECK(pairs > 3000);
    }
  }
}

TEST_CASE("A cell has the area of the ball's disk on a surface along the axes") {
  for (const Vec3& normal : {Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, -1)}) {
    for (const double r : {0.06, 0.08, 0.11}) {
      const RecordSet set = patch(20000, normal, 4, 7);
      EstimatorRun run(filter::Estimator::hash, r);
      const filter::Estimates result = run(set);
      // Sources a unit of area, times pi r^2; the record itself counts, and borders cost a little.
      const double expected = 20000.0 / 16 * 3.14159265 * r * r + 1;
      INFO("r " << r);
      CHECK(result.statistics.mean_neighbors() == Approx(expected).epsilon(0.1));
    }
  }
}

TEST_CASE("Cells grow with the distance, in steps of two") {
  const RecordSet set(1);
  const KeyMaker maker(set.view(), filter::WeightTerms::none(), 0.1, 0);
  for (double f = 0.5; f < 9; f *= 1.1) {
    const double ratio = maker.side(0.1 * f, 0) / (0.1 * f);
    CHECK(ratio > 1.7724 / 1.415);
    CHECK(ratio < 1.7725 * 1.415);
    CHECK(maker.side(0.1 * f, 3) == 8 * maker.side(0.1 * f, 0));
    const double power = std::log2(maker.side(0.1 * f, 0) / (0.1 * 1.7724538509055160));
    CHECK(power == Approx(std::round(power)).margin(1e-9));
  }
}

TEST_CASE("Jitter hides the grid: neighbours across any border share cells now and then") {
  RecordSet set(1000);
  // Two points a hundredth of a cell apart, many times: each record has a jitter of its own.
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.position[i] = Vec3(i % 2 == 0 ? 0.3f : 0.3018f, 0, 0.1f);
  }
  // Somewhere in the length of a cell a border lies between the two.
  for (int step = 0; step < 200; ++step) {
    for (Vec3& x : set.position) x.x += 0.0009f;
    const std::vector<CellKey> keys = keys_of(set, filter::WeightTerms::none(), 0.1f);
    std::size_t shared = 0;
    for (std::size_t i = 0; i + 1 < keys.size(); i += 2)
      shared += keys[i].compare(keys[i + 1]) == 0 ? 1u : 0u;
    // Two axes, of whose borders up to half of the records are on either side.
    CHECK(shared > keys.size() / 2 / 5);
  }
}

TEST_CASE("c_bar is the mean of the sources of the cell, and sums keep their mean") {
  const RecordSet set = patch(3000, Vec3(0, 1, 0), 1, 9);
  EstimatorRun run(filter::Estimator::hash, 0.1);
  const filter::Estimates result = run(set);
  const std::vector<CellKey> keys = [&] {
    const KeyMaker maker(set.view(), run.parameters.weights, 0.1, 0);
    std::vector<CellKey> all;
    for (std::uint32_t i = 0; i < set.size(); ++i) all.push_back(maker(i, 0.1f, 0));
    return all;
  }();
  double before = 0, after = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    double sum = 0, count = 0;
    for (std::size_t j = 0; j < set.size(); ++j) {
      if (keys[i].compare(keys[j]) != 0) continue;
      sum += double{set.contribution[j].x};
      ++count;
    }
    REQUIRE(result.neighbors[i] == count);
    REQUIRE(double{result.c_bar[i].x} == Approx(sum / count).epsilon(1e-6));
    before += double{set.contribution[i].x};
    after += double{result.c_bar[i].x};
  }
  // A cell's members all get its mean, so what a cell holds is neither more nor less than before.
  CHECK(after == Approx(before).epsilon(1e-6));
}

TEST_CASE("Queries without a source in their cell look into coarser cells, then for the nearest") {
  RecordSet set = patch(2000, Vec3(0, 1, 0), 1, 11);
  for (std::size_t i = 0; i < set.size(); ++i)
    if (i % 100 != 0) set.flags[i] = filter::kHasVertex;
  set.normal[7] = Vec3(1, 0, 0);  // nobody passes it
  EstimatorRun run(filter::Estimator::hash, 0.01);
  const filter::Estimates result = run(set);
  CHECK(result.statistics.orphans > 1000);
  CHECK(result.statistics.orphans_unmatched == 1);
  std::size_t known = 0;
  std::set<float> values;
  for (std::size_t j = 0; j < set.size(); j += 100) values.insert(set.contribution[j].x);
  for (std::size_t i = 0; i < set.size(); ++i) {
    CHECK(result.roles[i] != filter::Role::left_out);
    REQUIRE(result.c_bar[i].x >= *values.begin());
    known += values.count(result.c_bar[i].x);
  }
  CHECK(known < set.size());  // coarse cells have several sources
  CHECK(values.count(result.c_bar[7].x) == 1);
}

TEST_CASE("An infinite radius is one cell for all that pass; a huge one does not overflow") {
  const RecordSet set = patch(500, Vec3(0, 1, 0), 1, 12);
  const EstimatorRun run(filter::Estimator::hash);
  const filter::Block block{0, 1, 1, run.cameras};
  filter::Parameters parameters;
  parameters.estimator = filter::Estimator::hash;
  for (const float r : {std::numeric_limits<float>::infinity(), 1e30f}) {
    const std::vector<float> radius(set.size(), r);
    const filter::Estimates result = filter::estimate(set.view(), radius, block, parameters);
    CHECK(result.neighbors[0] > (std::isinf(r) ? 499u : 100u));
  }
}

}  // namespace
}  // namespace psf
