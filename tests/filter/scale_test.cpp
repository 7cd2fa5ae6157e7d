// Neighbours do not depend on the unit of length, as far as floats go.
#include <cmath>

#include "catch.h"
#include "engine_case.h"
#include "estimator_case.h"
#include "filter/many_radii.h"
#include "filter/radius.h"
#include "keep_averages.h"
#include "oracle.h"

namespace psf {
namespace {

using filter::Estimator;
using Kind = filter::EngineKind;
using tests::difference;
using tests::EngineCase;
using tests::RecordSet;

// Exponents of two: squares of lengths are ordinary numbers, infinite, without digits, or 0.
constexpr int kUnits[] = {-112, -100, -80, -70, -62, -20, 1, 58, 62, 64, 80, 100, 124};

const std::vector<filter::CameraView> kCameras = {{16, 10, 0.04}};

void scale(RecordSet& set, int exponent) {
  for (Vec3& x : set.position) {
    for (int axis = 0; axis < 3; ++axis) x[axis] = std::ldexp(x[axis], exponent);
  }
  for (float& d : set.distance) d = std::ldexp(d, exponent);
  for (float& h : set.hit_distance) h = std::ldexp(h, exponent);
}

EngineCase scaled(EngineCase c, int exponent) {
  scale(c.set, exponent);
  for (float& r : c.radius) r = std::ldexp(r, exponent);
  c.parameters.radius.r0 = std::ldexp(c.parameters.radius.r0, exponent);
  return c;
}

EngineCase case_of(Estimator estimator) {
  EngineCase c(800, 4, estimator == Estimator::control ? 0 : 0.3);
  c.parameters.estimator = estimator;
  c.parameters.radius = {0.25, filter::RadiusBasis::world};
  // A plane belongs to no cell.
  c.parameters.weights = tests::terms_of(estimator == Estimator::hash ? 2 : 18);
  c.parameters.count_refusals = estimator == Estimator::average;
  c.parameters.sources = estimator == Estimator::control ? 3 : 1;
  for (std::size_t i = 0; i < c.radius.size(); ++i) {
    c.radius[i] = i % 9 == 0 ? 0.001f : 0.3f * c.set.distance[i];  // there are orphans
  }
  return c;
}

TEST_CASE("Every search and estimator gives the same bytes in every unit of length") {
  for (const Estimator estimator : tests::all_estimators()) {
    const EngineCase c = case_of(estimator);
    for (const Kind kind : {Kind::flann, Kind::plain, Kind::brute}) {
      const filter::Estimates expected = c.filtered(kind);
      CHECK(expected.statistics.accepted > 2 * expected.statistics.queries);
      for (const int unit : kUnits) {
        INFO("estimator " << static_cast<int>(estimator) << ", search " << static_cast<int>(kind)
                          << ", 2^" << unit);
        const filter::Estimates found = scaled(c, unit).filtered(kind);
        CHECK(difference(found, expected) == "");
        bool same_radii = found.radius.size() == expected.radius.size();
        for (std::size_t i = 0; same_radii && i < found.radius.size(); ++i) {
          same_radii = found.radius[i] == std::ldexp(expected.radius[i], unit);
        }
        CHECK(same_radii);
      }
    }
  }
}

TEST_CASE("Neighbours in every unit of length are those of double precision") {
  for (const auto basis : {filter::RadiusBasis::distance, filter::RadiusBasis::world}) {
    for (const int unit : kUnits) {
      RecordSet set = tests::random_records(400, 11, 0.3, kCameras);
      scale(set, unit);
      filter::Parameters parameters;
      const double r0 = basis == filter::RadiusBasis::world ? std::ldexp(0.3, unit) : 0.3;
      parameters.radius = {r0, basis};
      parameters.weights = tests::terms_of(18);
      const filter::Block block{0, 3, 1.5, kCameras};
      std::vector<float> radius;
      filter::radii(parameters.radius, set.view(), block, radius);
      const filter::Estimates found = filter::estimate(set.view(), radius, block, parameters);
      const tests::OracleResult expected =
          tests::Oracle(set, parameters, kCameras, 3, 0, 1.5).run(0, set.size());
      std::size_t wrong = 0, neighbors = 0;
      for (std::size_t i = 0; i < set.size(); ++i) {
        if (!expected.has_average[i]) continue;
        wrong += found.neighbors[i] == expected.neighbors[i] ? 0u : 1u;
        neighbors += found.neighbors[i];
      }
      INFO("2^" << unit);
      CHECK(wrong == 0);
      CHECK(neighbors > set.size());
    }
  }
}

// c_bar of every record for every radius.
std::vector<std::vector<Rgb>> many(const EngineCase& c, const std::vector<filter::Radius>& radii) {
  tests::KeepAverages keep(c.set.size(), radii.size());
  filter::Parameters parameters = c.parameters;
  parameters.count_refusals = false;
  (void)filter::estimate_many(c.set.view(), {0, 1, 1.5, c.cameras}, parameters, radii, keep);
  return std::move(keep.c_bar);
}

TEST_CASE("Many radii at once give the same bytes in every unit of length") {
  for (const Estimator estimator : {Estimator::average, Estimator::disk}) {
    const EngineCase c = case_of(estimator);
    for (const auto basis : {filter::RadiusBasis::distance, filter::RadiusBasis::world}) {
      std::vector<filter::Radius> radii;
      for (const double r0 : {0.0, 0.01, 0.1, 0.2}) radii.push_back({r0, basis});
      const auto expected = many(c, radii);
      for (const int unit : kUnits) {
        std::vector<filter::Radius> in_unit = radii;
        if (basis == filter::RadiusBasis::world) {
          for (filter::Radius& radius : in_unit) radius.r0 = std::ldexp(radius.r0, unit);
        }
        INFO("2^" << unit);
        CHECK(many(scaled(c, unit), in_unit) == expected);
      }
    }
  }
}

TEST_CASE("A vertex that is absurdly far away changes nothing for the others") {
  for (const float far : {1e20f, 3e38f}) {
    EngineCase c(600, 8);
    c.parameters.weights = tests::terms_of(3);
    const filter::Estimates expected = c.filtered(Kind::brute);
    EngineCase with = c;
    with.set.position[7] = Vec3(far, -far, far);
    with.set.flags[7] = filter::kHasVertex | filter::kShaded;
    const bool too_far_as_well = far > 1e30f;
    if (too_far_as_well) with.set.distance[7] = far;
    for (const Kind kind : {Kind::flann, Kind::plain, Kind::brute}) {
      const filter::Estimates found = with.filtered(kind);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < c.set.size(); ++i) {
        const bool near = search::distance_sq(c.set.position[i], c.set.position[7]) < 0.05f;
        if (i != 7 && !near) wrong += found.neighbors[i] == expected.neighbors[i] ? 0u : 1u;
      }
      CHECK(wrong == 0);
      CHECK(found.neighbors[7] == 1);
    }
  }
}

}  // namespace
}  // namespace psf
