// [density]: photons against a closed form, every pair in double, and what is always true.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "estimator_case.h"
#include "filter/many_radii.h"
#include "keep_averages.h"
#include "photon_set.h"

namespace psf {
namespace {

using filter::Estimates;
using Kind = filter::EngineKind;
using tests::density_at;
using tests::PhotonSet;
using tests::RecordSet;

constexpr std::array kSearches = {Kind::flann, Kind::plain, Kind::brute};

filter::WeightTerms terms_of_bits(unsigned bits) {
  filter::WeightTerms terms = filter::WeightTerms::none();
  if ((bits & 1) != 0) terms.normal = 0.93f;
  if ((bits & 2) != 0) terms.plane = 0.4f;
  terms.material = (bits & 4) != 0;
  return terms;
}

RecordSet lattice_records(std::size_t count) {
  return tests::random_records(count, 8, 0.2, tests::kCamera);
}

bool same(const Estimates& a, const Estimates& b) {
  return tests::same_bytes(a.c_bar, b.c_bar) && a.neighbors == b.neighbors && a.roles == b.roles;
}

TEST_CASE("Photons of a uniform flux density E show rho E / pi") {
  // Three passes of 60,000 photons on 3 x 3 units around the unit square; behind it as many again.
  constexpr double kFlux = 7, kArea = 9, kRadius = 0.05, kPhotons = 60000, kTimes = 3;
  PhotonSet photons(static_cast<std::size_t>(2 * kTimes * kPhotons));
  photons.passes = 3;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-1, 2);
  for (std::size_t p = 0; p < photons.size(); ++p) {
    photons.position[p] = Vec3(place(random), 0, place(random));
    photons.power[p] = Rgb(static_cast<float>(kFlux * kArea / kPhotons));
    if (p % 2 == 1) photons.normal[p] = photons.direction[p] = Vec3(0, -1, 0);
  }
  RecordSet set(100);  // disks that do not overlap
  for (std::size_t i = 0; i < set.size(); ++i) {
    set.position[i] = Vec3(static_cast<float>(i % 10) / 9, 0, static_cast<float>(i / 10) / 9);
    set.reflectance[i] = Rgb(0.9f, 0.5f, 0.1f);
  }
  const double expected = kFlux / std::numbers::pi;
  const double count = kTimes * kPhotons * std::numbers::pi * kRadius * kRadius / kArea;
  // Without weights too: what arrives from behind is never in.
  for (const filter::WeightTerms& terms : {filter::WeightTerms::none(), terms_of_bits(7)}) {
    const Estimates result =
        tests::run_density(set, photons, tests::density_parameters(terms, kRadius));
    double mean = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      const double relative = double{result.c_bar[i].x} / (0.9 * expected) - 1;
      CHECK(std::abs(relative) < 5 / std::sqrt(count));
      CHECK(result.c_bar[i].y / result.c_bar[i].x == Approx(5.0 / 9));
      CHECK(result.c_bar[i].z / result.c_bar[i].x == Approx(1.0 / 9));
      mean += relative / 100;
    }
    CHECK(std::abs(mean) < 4 / std::sqrt(100 * count));
    CHECK(result.statistics.mean_neighbors() == Approx(count).epsilon(4 / std::sqrt(100 * count)));
    CHECK(result.statistics.photons == photons.size());
  }
}

TEST_CASE("Density is that of every pair in double, by every search, with every subset of terms") {
  const RecordSet set = lattice_records(700);
  const PhotonSet photons = tests::random_photons(1500, 3);
  std::size_t neighbors = 0;
  for (unsigned bits = 0; bits < 8; ++bits) {
    for (const double r : {0.05, 0.2, 3.0}) {
      auto parameters = tests::density_parameters(terms_of_bits(bits), r);
      std::optional<Estimates> first;
      for (const Kind engine : kSearches) {
        parameters.engine = engine;
        const Estimates result = tests::run_density(set, photons, parameters);
        if (!first) first = result;
        CHECK(same(result, *first));  // whole numbers are added up without rounding
      }
      INFO("terms " << bits << ", radius " << r);
      const double r_i = double{static_cast<float>(r)};
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.flags[i] == 0) continue;
        const auto expected = density_at(set, i, r_i, photons, 0, photons.size(), photons.passes,
                                         terms_of_bits(bits));
        neighbors += expected.neighbors;
        wrong += first->neighbors[i] == expected.neighbors ? 0u : 1u;
        for (int k = 0; k < 3; ++k) {
          const double c = expected.c[static_cast<std::size_t>(k)];
          wrong += std::abs(double{first->c_bar[i][k]} - c) <= 1e-6 * c ? 0u : 1u;
        }
      }
      CHECK(wrong == 0);
    }
  }
  CHECK(neighbors > 100000);
}

TEST_CASE("Density is the same bytes for any number of threads") {
  RecordSet set = lattice_records(9000);
  PhotonSet photons = tests::random_photons(20000, 4);
  for (Rgb& power : photons.power) power *= 0.1f;  // sums round
  std::optional<Estimates> one;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    const core::ThreadLimit limit(threads);
    const Estimates result =
        tests::run_density(set, photons, tests::density_parameters(terms_of_bits(3), 0.2));
    if (!one) one = result;
    CHECK(same(result, *one));
  }
}

TEST_CASE("Density is the same in every unit of length, in which power is of an area") {
  const RecordSet set = lattice_records(500);
  const PhotonSet photons = tests::random_photons(900, 5);
  for (const Kind engine : kSearches) {
    auto parameters = tests::density_parameters(terms_of_bits(3), 0.2);
    parameters.engine = engine;
    const Estimates expected = tests::run_density(set, photons, parameters);
    for (const int unit : {-55, -21, 3, 30, 58}) {
      RecordSet far = set;
      PhotonSet others = photons;
      for (Vec3& x : far.position) x *= std::ldexp(1.0f, unit);
      for (Vec3& x : others.position) x *= std::ldexp(1.0f, unit);
      for (Rgb& power : others.power) power *= std::ldexp(1.0f, 2 * unit);
      parameters.radius.r0 = std::ldexp(0.2, unit);
      INFO("2^" << unit);
      CHECK(same(tests::run_density(far, others, parameters), expected));
    }
  }
}

TEST_CASE("With r0 = 0 density gives each contribution back, bit for bit; in the dark it is 0") {
  RecordSet set = lattice_records(900);
  set.contribution[4] = Rgb(-0.0f, 1e-42f, 3e38f);
  PhotonSet photons = tests::random_photons(900, 6);
  const Estimates point =
      tests::run_density(set, photons, tests::density_parameters(terms_of_bits(0), 0));
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Rgb c = set.flags[i] == 3 ? set.contribution[i] : Rgb(0, 0, 0);
    CHECK(std::memcmp(&point.c_bar[i], &c, sizeof c) == 0);
  }
  for (Vec3& x : photons.position) x += Vec3(100, 0, 0);
  for (const Kind engine : kSearches) {
    auto parameters = tests::density_parameters(terms_of_bits(1), 0.3);
    parameters.engine = engine;
    const Estimates dark = tests::run_density(set, photons, parameters);
    CHECK(std::all_of(dark.c_bar.begin(), dark.c_bar.end(), is_black));
    CHECK(dark.statistics.orphans == 0);
    CHECK(dark.statistics.min_neighbors == 0);
  }
}

TEST_CASE("Photons that are not finite are left out and counted, and so are records without rho") {
  RecordSet set = lattice_records(500);
  PhotonSet photons = tests::random_photons(800, 7), others = photons;
  photons.position[3].z = tests::kInfinity;
  photons.power[5].x = tests::kNan;
  photons.direction[9].y = tests::kNan;
  for (const std::size_t p : {3u, 5u, 9u}) others.position[p] = Vec3(1000, 0, 0);
  const auto parameters = tests::density_parameters(terms_of_bits(1), 0.3);
  const Estimates result = tests::run_density(set, photons, parameters);
  CHECK(same(result, tests::run_density(set, others, parameters)));
  CHECK(result.statistics.photons == 797);
  CHECK(result.statistics.photons_left_out == 3);
  CHECK(result.statistics.left_out == 0);
  const auto vertex = std::find(set.flags.begin(), set.flags.end(), 3) - set.flags.begin();
  set.reflectance[static_cast<std::size_t>(vertex)].y = tests::kNan;
  CHECK(tests::run_density(set, photons, parameters).statistics.left_out == 1);
}

TEST_CASE("Many radii of density are what separate runs give") {
  const RecordSet set = lattice_records(900);
  const PhotonSet photons = tests::random_photons(2000, 9);
  const filter::Records records = tests::with_photons(set, photons);
  const filter::Block block{0, 9, 1, tests::kCamera};
  std::vector<filter::Radius> radii;
  for (const double r0 : {0.0, 0.03, 0.1, 0.4}) {
    for (const double delta : {0.0, 0.5}) {
      radii.push_back({r0, filter::RadiusBasis::distance, delta, {}});
    }
  }
  for (const Kind engine : {Kind::flann, Kind::brute}) {
    auto parameters = tests::density_parameters(terms_of_bits(5), 0);
    parameters.engine = engine;
    tests::KeepAverages keep(set.size(), radii.size());
    const filter::ManyEstimates many =
        filter::estimate_many(records, block, parameters, radii, keep);
    for (std::size_t k = 0; k < radii.size(); ++k) {
      parameters.radius = radii[k];
      const Estimates alone = tests::run_density(set, photons, parameters, 9);
      CHECK(tests::same_bytes(keep.c_bar[k], alone.c_bar));
      CHECK(many.roles == alone.roles);
      CHECK(many.statistics[k].accepted == alone.statistics.accepted);
      CHECK(many.statistics[k].max_neighbors == alone.statistics.max_neighbors);
      CHECK(many.statistics[k].orphans == 0);
    }
  }
}

TEST_CASE("What density cannot do is refused in one line that names the option") {
  const RecordSet set = lattice_records(50);
  const PhotonSet photons = tests::random_photons(50, 1);
  const auto starts = [&](auto change, const char* with) {
    auto parameters = tests::density_parameters(terms_of_bits(0), 0.1);
    change(parameters);
    CHECK_THROWS_WITH(tests::run_density(set, photons, parameters),
                      Catch::Matchers::StartsWith(with));
  };
  using filter::Parameters;
  starts([](Parameters& p) { p.demodulate = true; }, "`demodulate`:");
  starts([](Parameters& p) { p.iterations = 2; }, "`iterations`:");
  starts([](Parameters& p) { p.sources = 2; }, "`sources`:");
  PhotonSet none(0);
  none.passes = 0;
  CHECK_THROWS_WITH(
      tests::run_density(set, none, tests::density_parameters(terms_of_bits(0), 0.1)),
      "the records have no photons, which `estimator density` needs; only a dump has them");
}

}  // namespace
}  // namespace psf
