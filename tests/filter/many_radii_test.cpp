// Many radii in one traversal give what separate runs with plain FLANN give, to the last neighbour.
#include "filter/many_radii.h"

#include <cmath>
#include <utility>

#include "catch.h"
#include "core/parallel.h"
#include "engine_case.h"
#include "filter/radius.h"
#include "keep_averages.h"

namespace psf {
namespace {

using filter::Radius;
using filter::RadiusBasis;
using filter::Role;
using tests::EngineCase;

struct Result {
  filter::ManyEstimates many;
  std::vector<std::vector<Rgb>> c_bar;  // by radius, record
  std::size_t seen = 0;                 // averages
};

Result many(const EngineCase& c, const filter::Block& block, const std::vector<Radius>& radii) {
  filter::Parameters parameters = c.parameters;
  parameters.count_refusals = false;
  Result r;
  tests::KeepAverages keep(c.set.size(), radii.size());
  r.many = filter::estimate_many(c.set.view(), block, parameters, radii, keep);
  r.c_bar = std::move(keep.c_bar);
  r.seen = keep.seen;
  return r;
}

// Returns how many pairs passed in all.
std::uint64_t check_radii(const EngineCase& c, const std::vector<Radius>& radii, double n = 9) {
  const filter::Block block{0, n, 1.5, c.cameras};
  const Result r = many(c, block, radii);
  std::uint64_t accepted = 0;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    filter::Parameters separate = c.parameters;
    separate.radius = radii[k];
    separate.engine = filter::EngineKind::plain;
    separate.count_refusals = false;
    std::vector<float> radius;
    filter::radii(radii[k], c.set.view(), block, radius);
    const filter::Estimates expected = filter::estimate(c.set.view(), radius, block, separate);
    // Contributions tell records apart: equal averages are of the same ones.
    filter::Estimates found{r.many.roles, r.c_bar[k], expected.neighbors, r.many.statistics[k]};
    INFO("radius " << k << ": " << radii[k].r0 << ", delta " << radii[k].delta);
    CHECK(tests::difference(found, expected) == "");
    CHECK(found.statistics.queries == expected.statistics.queries);
    CHECK(found.statistics.sources == expected.statistics.sources);
    accepted += found.statistics.accepted;
  }
  const std::uint64_t queries = r.many.statistics[0].queries;
  CHECK(r.seen == (r.many.statistics[0].without_source > 0 ? 0 : queries * radii.size()));
  return accepted;
}

// Pairs of r0 and delta.
std::vector<Radius> grid(RadiusBasis basis, double least, double most, std::size_t count) {
  std::vector<Radius> radii;
  for (std::size_t k = 0; k < count; ++k) {
    const double r0 =
        least * std::pow(most / least, static_cast<double>(k) / static_cast<double>(count - 1));
    for (const double delta : {0.5, 0.0, 1.0 / 3}) {
      radii.push_back({r0, basis, delta, filter::RadiusCount::samples});
    }
  }
  return radii;
}

TEST_CASE("Many radii agree with separate runs, with every subset of terms") {
  for (unsigned bits = 0; bits < 256; ++bits) {
    EngineCase c(700, bits, bits % 2 == 0 ? 0.4 : 0);
    c.parameters.weights = tests::terms_of(bits);
    INFO("terms " << bits);
    CHECK(check_radii(c, grid(RadiusBasis::distance, 0.02, 0.6, 7)) > 3000);
  }
}

TEST_CASE("Many radii agree with separate runs where points lie exactly on the spheres") {
  EngineCase c(3000, 5, 0.1);
  c.parameters.weights = tests::terms_of(7);
  std::vector<Radius> radii;
  for (int k = 0; k < 24; ++k) radii.push_back({k / 64.0, RadiusBasis::world, 0});
  CHECK(check_radii(c, radii) > 100000);
}

TEST_CASE("Many radii agree whatever the number of records and of radii") {
  for (const std::size_t count : {1u, 2u, 15u, 17u, 255u, 257u, 4097u}) {
    for (const double unshaded : {0.0, 0.4}) {
      EngineCase c(count, static_cast<std::uint32_t>(count), unshaded);
      c.parameters.weights = tests::terms_of(7);
      INFO(count << " records, unshaded " << unshaded);
      check_radii(c, {{0.2, RadiusBasis::distance, 0.4}});
      check_radii(c, grid(RadiusBasis::footprint, 1, 12, 4));
    }
  }
  EngineCase c(600, 3, 0.1);
  check_radii(c, grid(RadiusBasis::distance, 0.01, 0.5, 67));
  check_radii(c, grid(RadiusBasis::distance, 0.01, 0.5, 90));
}

TEST_CASE("Many radii agree for the same scale twice, for none and for scales far apart") {
  const EngineCase c(600, 8, 0.2);
  check_radii(c, {{0.2, RadiusBasis::distance, 0.4},
                  {0.1, RadiusBasis::distance, 0},
                  {0.2, RadiusBasis::distance, 0.4}});
  check_radii(c,
              {{0.2, RadiusBasis::distance, 0.4},
               {0.1, RadiusBasis::distance, 0},
               {0.2, RadiusBasis::distance, 0.1}},
              1);
  check_radii(c, {{0, RadiusBasis::distance, 0.4}});
  check_radii(c, {{0, RadiusBasis::distance, 0.4}, {0.3, RadiusBasis::distance, 0.4}});
  check_radii(c, {{1e-8, RadiusBasis::world, 0},
                  {0.3, RadiusBasis::world, 0.4},
                  {1e8, RadiusBasis::world, 0.4}});
  check_radii(c, {{1e-30, RadiusBasis::world, 0},
                  {0.3, RadiusBasis::world, 0.4},
                  {1e30, RadiusBasis::world, 0.4}});
}

TEST_CASE("Many radii agree where distances, sources or values are out of the ordinary") {
  const std::vector<Radius> radii = grid(RadiusBasis::distance, 0.02, 0.5, 5);
  EngineCase c(900, 11, 0.1);
  c.parameters.weights = tests::terms_of(7);
  SECTION("chosen sources") {
    c.parameters.sources = 7;
  }
  SECTION("no distance") {
    c.set.distance.assign(900, 0.0f);
  }
  SECTION("few without distance") {
    for (std::size_t i = 0; i < 900; i += 7) c.set.distance[i] = i % 2 == 0 ? 0.0f : -1.0f;
  }
  SECTION("tiny and huge distances") {
    for (std::size_t i = 0; i < 900; i += 5) c.set.distance[i] = i % 2 == 0 ? 1e-12f : 1e12f;
  }
  SECTION("no sources") {
    c.set.flags.assign(900, filter::kHasVertex);
  }
  SECTION("values that only plain FLANN takes") {
    c.set.position[3].x = 1e20f;
  }
  check_radii(c, radii);
}

TEST_CASE("Many radii agree to rounding where sums are rounded") {
  const std::vector<Radius> radii = grid(RadiusBasis::distance, 0.02, 0.5, 5);
  EngineCase c(900, 12, 0.1);
  c.parameters.weights = tests::terms_of(7);
  SECTION("disk") {
    c.parameters.estimator = filter::Estimator::disk;
  }
  SECTION("demodulated") {
    c.parameters.demodulate = true;
  }
  SECTION("iterated") {
    c.parameters.iterations = 2;
  }
  const filter::Block block{0, 4, 1.5, c.cameras};
  const Result r = many(c, block, radii);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    filter::Parameters separate = c.parameters;
    separate.count_refusals = false;
    separate.engine = filter::EngineKind::brute;
    separate.radius = radii[k];
    std::vector<float> radius;
    filter::radii(radii[k], c.set.view(), block, radius);
    const filter::Estimates expected = filter::estimate(c.set.view(), radius, block, separate);
    const filter::Estimates found{r.many.roles, r.c_bar[k], expected.neighbors,
                                  r.many.statistics[k]};
    CHECK(tests::difference(found, expected, 1e-5f) == "");
  }
}

TEST_CASE("Many radii give the same bytes for any number of threads") {
  EngineCase c(5000, 13, 0.1);
  c.parameters.weights = tests::terms_of(7);
  for (Rgb& value : c.set.contribution) value.x *= 1.1f;
  const filter::Block block{0, 4, 1.5, c.cameras};
  const std::vector<Radius> radii = grid(RadiusBasis::distance, 0.02, 0.5, 9);
  const Result one = [&] {
    const core::ThreadLimit limit(1);
    return many(c, block, radii);
  }();
  const core::ThreadLimit limit(3);
  const Result three = many(c, block, radii);
  for (std::size_t k = 0; k < radii.size(); ++k) {
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      CHECK(std::memcmp(&one.c_bar[k][i], &three.c_bar[k][i], sizeof(Rgb)) == 0);
    }
  }
}

}  // namespace
}  // namespace psf
