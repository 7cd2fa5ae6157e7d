// Vertices in volumes are averaged with each other alone, and no term asks them for a surface: every
// engine finds what the oracle finds in the two halves, and every estimator is that of each half.
#include "filter/kinds.h"

#include <array>
#include <cmath>
#include <cstring>

#include "catch.h"
#include "engine_case.h"
#include "estimator_case.h"
#include "filter/many_radii.h"
#include "filter/radius.h"
#include "keep_averages.h"
#include "oracle.h"

namespace psf {
namespace {

using filter::EngineKind;
using filter::Estimates;
using filter::Estimator;
using tests::EngineCase;
using tests::kEngines;
using tests::RecordSet;

constexpr float kRadius = 0.2f;
const std::vector<filter::CameraView> kKindsCamera = {{16, 10, 0.04}};

// Records of which a third is in volumes. There normals are 0 or not finite, and so are directions
// and roughnesses.
struct Mixed {
  RecordSet set;
  std::vector<std::uint8_t> kind;

  explicit Mixed(std::size_t count, std::uint32_t seed, double share_unshaded)
      : set(EngineCase(count, seed, share_unshaded).set), kind(count) {
    for (std::size_t i = 0; i < count; ++i) {
      kind[i] = std::array<std::uint8_t, 6>{0, 2, 1, 2, 0, 7}[(i * 7 + i / 11) % 6];
      if (kind[i] != 2) continue;
      set.normal[i] = i % 2 == 0 ? Vec3(0, 0, 0) : Vec3(tests::kNan, 0, 1);
      set.direction[i] = Vec3(0, tests::kInfinity, 0);
      set.roughness[i] = tests::kNan;
    }
  }
  [[nodiscard]] filter::Records view() const {
    filter::Records records = set.view();
    records.kind = kind;
    return records;
  }
  // The records without the vertices in volumes, or without all others.
  [[nodiscard]] Mixed half(bool volumes) const {
    Mixed some = *this;
    for (std::size_t i = 0; i < kind.size(); ++i) {
      if ((kind[i] == 2) != volumes) some.set.flags[i] = 0;
    }
    return some;
  }
};

// What the terms and the estimator are in a volume, from the README.
filter::Parameters in_volumes(filter::Parameters p) {
  p.weights.normal = p.weights.reflectance = p.weights.plane = p.weights.direction =
      p.weights.gloss = std::nullopt;
  if (p.estimator == Estimator::disk) p.estimator = Estimator::average;
  return p;
}

Estimates filtered(const Mixed& mixed, const filter::Parameters& parameters) {
  const std::vector<float> radius(mixed.kind.size(), kRadius);
  return filter::estimate(mixed.view(), radius, {0, 1, 1.5, kKindsCamera}, parameters);
}

// Of the oracle's result for a half. Returns how many pairs it averaged.
std::size_t check_half(const Mixed& mixed, const Estimates& found, filter::Parameters p,
                       bool volumes) {
  if (volumes) p = in_volumes(p);
  const Mixed half = mixed.half(volumes);
  const tests::OracleResult expected =
      tests::Oracle(half.set, p, kKindsCamera, 1, 0, 1.5).run(0, half.kind.size());
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < half.kind.size(); ++i) {
    if (!expected.has_average[i]) continue;
    CAPTURE(i, volumes);
    if (!filter::is_query(found.roles[i])) FAIL("no query");
    if (found.neighbors[i] != expected.neighbors[i]) FAIL("other neighbours");
    pairs += expected.neighbors[i];
    for (int k = 0; k < 3; ++k) {
      const double c = expected.c_bar[i][static_cast<std::size_t>(k)];
      if (std::abs(double{found.c_bar[i][k]} - c) > 1e-5 * (1 + std::abs(c))) FAIL("another c_bar");
    }
  }
  return pairs;
}

}  // namespace

TEST_CASE("Every engine finds in surfaces and volumes what the oracle finds in each") {
  const Mixed mixed(160, 5, 0.3);
  for (unsigned bits = 0; bits < 256; ++bits) {
    filter::Parameters p;
    p.weights = tests::terms_of(bits);
    p.radius = {double{kRadius}, filter::RadiusBasis::world};
    p.demodulate = bits % 3 == 0;
    p.iterations = bits % 5 == 0 ? 2 : 1;
    p.estimator = bits % 7 == 0 ? Estimator::disk : Estimator::average;
    if (p.estimator == Estimator::disk) p.iterations = 1;
    for (const EngineKind engine : kEngines) {
      p.engine = engine;
      CAPTURE(bits, static_cast<int>(engine));
      const Estimates found = filtered(mixed, p);
      // With no term, and with all, which leave little but records themselves.
      CHECK(check_half(mixed, found, p, false) >= (bits == 0 ? 150 : 50));
      CHECK(check_half(mixed, found, p, true) >= (bits == 0 ? 50 : 25));
      CHECK(found.statistics.left_out == 0);
      CHECK(found.statistics.records == mixed.kind.size());
    }
  }
}

TEST_CASE("What the fast engine counts of pairs of each kind is what the plain one counts") {
  const Mixed mixed(700, 6, 0.2);
  for (const unsigned bits : {0u, 1u, 5u, 17u, 129u, 255u}) {
    filter::Parameters p;
    p.weights = tests::terms_of(bits);
    p.count_refusals = true;
    p.engine = EngineKind::plain;
    const Estimates plain = filtered(mixed, p);
    p.engine = EngineKind::flann;
    CHECK(tests::difference(filtered(mixed, p), plain) == "");
    CHECK(plain.statistics.candidates > plain.statistics.queries);
  }
}

TEST_CASE("An estimator of all vertices is that of surfaces and that of volumes") {
  const Mixed mixed(500, 7, 0);
  for (const Estimator estimator : tests::all_estimators()) {
    for (const EngineKind engine : kEngines) {
      filter::Parameters p;
      p.estimator = estimator;
      p.engine = engine;
      p.sources = estimator == Estimator::control ? 2 : 1;
      CAPTURE(tests::name_of(estimator), static_cast<int>(engine));
      const Estimates all = filtered(mixed, p);
      const Estimates surfaces = filtered(mixed.half(false), p);
      const Estimates volumes = filtered(mixed.half(true), in_volumes(p));
      CHECK(all.radius.empty() == surfaces.radius.empty());
      std::size_t met = 0;
      for (std::size_t i = 0; i < mixed.kind.size(); ++i) {
        if (mixed.set.flags[i] == 0) continue;
        const Estimates& of = mixed.kind[i] == 2 ? volumes : surfaces;
        met += mixed.kind[i] == 2 ? 1u : 0u;
        CAPTURE(i);
        if (all.neighbors[i] != of.neighbors[i] || all.roles[i] != of.roles[i]) FAIL("neighbours");
        if (std::memcmp(&all.c_bar[i], &of.c_bar[i], sizeof(Rgb)) != 0) FAIL("another c_bar");
        if (!all.radius.empty() && all.radius[i] != of.radius[i]) FAIL("another radius");
      }
      CHECK(met > 100);
    }
  }
}

TEST_CASE("Many radii at once are those of separate runs, in volumes too") {
  const Mixed mixed(600, 8, 0.2);
  for (const Estimator estimator : {Estimator::average, Estimator::disk, Estimator::adaptive}) {
    filter::Parameters p;
    p.estimator = estimator;
    std::vector<filter::Radius> radii;
    for (const double r0 : {0.05, 0.1, 0.2, 0.4}) radii.push_back({r0, filter::RadiusBasis::world});
    const filter::Block block{0, 4, 1.5, kKindsCamera};
    tests::KeepAverages keep(mixed.kind.size(), radii.size());
    const filter::ManyEstimates many = filter::estimate_many(mixed.view(), block, p, radii, keep);
    for (std::size_t k = 0; k < radii.size(); ++k) {
      std::vector<float> radius;
      filter::radii(radii[k], mixed.view(), block, radius);
      p.radius = radii[k];
      const Estimates expected = filter::estimate(mixed.view(), radius, block, p);
      const Estimates found{many.roles, keep.c_bar[k], expected.neighbors, many.statistics[k]};
      CAPTURE(tests::name_of(estimator), k);
      CHECK(tests::difference(found, expected, 1e-6f) == "");
      CHECK(found.statistics.records == expected.statistics.records);
      CHECK(found.statistics.queries == expected.statistics.queries);
    }
  }
}

TEST_CASE("A surface without a normal is left out, a volume is not") {
  RecordSet set(6);
  for (std::size_t i = 0; i < 6; ++i) set.normal[i] = Vec3(tests::kNan, 0, 0);
  Mixed mixed(6, 1, 0);
  mixed.set = set;
  mixed.kind = {0, 2, 2, 1, 2, 0};
  for (const Estimator estimator : {Estimator::average, Estimator::hash, Estimator::disk}) {
    filter::Parameters p;
    p.estimator = estimator;
    const Estimates found = filtered(mixed, p);
    CAPTURE(tests::name_of(estimator));
    CHECK(found.statistics.left_out == 3);
    CHECK(found.statistics.records == 6);
    if (estimator == Estimator::hash) continue;  // jitter parts what lies in one place
    CHECK(found.neighbors == std::vector<std::uint32_t>{0, 3, 3, 0, 3, 0});
  }
}

TEST_CASE("An orphan takes the nearest of its kind, and without any it is in no picture") {
  Mixed mixed(4, 1, 0);
  mixed.set = RecordSet(4);
  mixed.set.flags[0] = filter::kHasVertex;
  for (std::size_t i = 1; i < 4; ++i) {
    mixed.set.position[i].x = static_cast<float>(i);
    mixed.set.contribution[i] = Rgb(static_cast<float>(i));
  }
  mixed.kind = {2, 0, 2, 0};
  for (const EngineKind engine : kEngines) {
    filter::Parameters p;
    p.engine = engine;
    mixed.kind[2] = 2;
    CHECK(filtered(mixed, p).c_bar[0] == Rgb(2));
    mixed.kind[2] = 1;
    const Estimates alone = filtered(mixed, p);
    CHECK(alone.roles[0] == filter::Role::left_out);
    CHECK(alone.statistics.without_source == 1);
    CHECK(alone.statistics.left_out == 0);
  }
}

TEST_CASE("Without a vertex in a volume the kind changes no bit") {
  const Mixed mixed(900, 9, 0);
  Mixed surfaces = mixed.half(false);
  for (const Estimator estimator : tests::all_estimators()) {
    filter::Parameters p;
    p.estimator = estimator;
    const Estimates with = filtered(surfaces, p);
    Mixed without = surfaces;
    without.kind.clear();
    const std::vector<float> radius(mixed.kind.size(), kRadius);
    const Estimates expected =
        filter::estimate(without.set.view(), radius, {0, 1, 1.5, kKindsCamera}, p);
    CHECK(tests::difference(with, expected) == "");
  }
}

}  // namespace psf
