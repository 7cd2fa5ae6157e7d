// [fit] against its equations, solved in another way, and what must hold of it.
#include "filter/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "catch.h"
#include "core/error.h"
#include "core/parallel.h"
#include "engine_case.h"
#include "estimator_case.h"
#include "oracle.h"

namespace psf {
namespace {

using filter::BallFit;
using filter::EngineKind;
using filter::Estimates;
using tests::EngineCase;
using tests::inner;
using tests::kEngines;
using tests::minus;
using tests::RecordSet;
using tests::Triple;
using tests::triple;

// The unknowns are the constant and the gradients over place and normal as vectors of the world,
// which are held to the tangent plane by equations of their own: Gauss elimination of all of them,
// in long double, with pivots.
constexpr std::size_t kUnknowns = 9;
struct Equations {
  long double left[kUnknowns][kUnknowns] = {};
  long double right[kUnknowns][3] = {};

  void add(const std::array<long double, 7>& f, const Triple& c) {
    for (std::size_t a = 0; a < f.size(); ++a) {
      for (std::size_t b = 0; b < f.size(); ++b) left[a][b] += f[a] * f[b];
      for (std::size_t k = 0; k < 3; ++k) right[a][k] += f[a] * static_cast<long double>(c[k]);
    }
  }
  // The constants. `n`: what both gradients are orthogonal to.
  Triple solve(long double ridge, const Triple& n) {
    for (std::size_t a = 1; a < 7; ++a) left[a][a] += ridge;
    for (std::size_t k = 0; k < 3; ++k) {
      left[7][1 + k] = left[1 + k][7] = static_cast<long double>(n[k]);
      left[8][4 + k] = left[4 + k][8] = static_cast<long double>(n[k]);
    }
    for (std::size_t a = 0; a < kUnknowns; ++a) {
      std::size_t best = a;
      for (std::size_t b = a; b < kUnknowns; ++b) {
        if (std::abs(left[b][a]) > std::abs(left[best][a])) best = b;
      }
      std::swap(left[a], left[best]);
      std::swap(right[a], right[best]);
      for (std::size_t b = 0; b < kUnknowns; ++b) {
        if (b == a) continue;
        const long double factor = left[b][a] / left[a][a];
        for (std::size_t c = a; c < kUnknowns; ++c) left[b][c] -= factor * left[a][c];
        for (std::size_t k = 0; k < 3; ++k) right[b][k] -= factor * right[a][k];
      }
    }
    Triple result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = static_cast<double>(right[0][k] / left[0][0]);
    return result;
  }
};

double brightness(const Triple& c) {
  return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

// Of record i, by the definition of src/filter/README.md; `terms`: none or `material`.
Triple by_equations(const EngineCase& c, std::size_t i) {
  const RecordSet& s = c.set;
  const auto r = static_cast<long double>(c.radius[i]);
  Equations equations;
  double count = 0, sum = 0, sum_sq = 0;
  for (std::size_t j = 0; j < s.size(); ++j) {
    if (s.flags[j] != 3) continue;
    const Triple d = minus(triple(s.position[j]), triple(s.position[i]));
    const bool near = j == i || inner(d, d) < double{c.radius[i]} * double{c.radius[i]};
    const bool like = !c.parameters.weights.material || s.material[i] == s.material[j];
    if (!near || !like) continue;
    const Triple n = minus(triple(s.normal[j]), triple(s.normal[i]));
    std::array<long double, 7> f = {1};
    for (std::size_t k = 0; k < 3; ++k) {
      f[1 + k] = static_cast<long double>(d[k]) / r;
      f[4 + k] = 5 * static_cast<long double>(n[k]);
    }
    // What is along the normal of i is no feature.
    const Triple own = triple(s.normal[i]);
    for (const std::size_t first : {1u, 4u}) {
      long double along = 0;
      for (std::size_t k = 0; k < 3; ++k) along += f[first + k] * static_cast<long double>(own[k]);
      for (std::size_t k = 0; k < 3; ++k) f[first + k] -= along * static_cast<long double>(own[k]);
    }
    const Triple value = triple(s.contribution[j]);
    equations.add(f, value);
    ++count;
    sum += brightness(value);
    sum_sq += brightness(value) * brightness(value);
  }
  const double mean = sum / count, variance = sum_sq / count - mean * mean;
  const double ridge = 0.01 + (count * variance / (mean * mean) + 1) / (count - 1);
  Triple result = equations.solve(static_cast<long double>(ridge), triple(s.normal[i]));
  for (double& component : result) component = std::max(component, 0.0);
  return result;
}

EngineCase some_case(std::size_t count, std::uint32_t seed, float r, bool material) {
  EngineCase c(count, seed, 0.2);
  c.radius.assign(count, r);
  c.parameters.weights.material = material;
  c.parameters.fit = BallFit::linear;
  return c;
}

TEST_CASE("A fit is the constant of its equations, by every engine") {
  for (const float r : {0.1f, 0.3f, 3.0f}) {
    for (const bool material : {false, true}) {
      const EngineCase c = some_case(700, 11, r, material);
      for (const EngineKind engine : kEngines) {
        const Estimates result = c.filtered(engine);
        INFO("radius " << r << ", engine " << static_cast<int>(engine));
        std::size_t compared = 0, bent = 0;
        EngineCase mean = c;
        mean.parameters.fit = BallFit::mean;
        const Estimates means = mean.filtered(engine);
        for (std::size_t i = 0; i < c.set.size(); ++i) {
          if (result.neighbors[i] < 2) continue;
          const Triple expected = by_equations(c, i);
          for (std::size_t k = 0; k < 3; ++k) {
            const double scale = double{means.c_bar[i][static_cast<int>(k)]};
            REQUIRE(double{result.c_bar[i][static_cast<int>(k)]} ==
                    Approx(expected[k]).epsilon(0).margin(2e-5 * scale));
          }
          ++compared;
          const float share = result.c_bar[i].x / means.c_bar[i].x;
          bent += std::abs(share - 1) > 0.01f ? 1u : 0u;
        }
        CHECK(compared > 200);
        CHECK(bent > compared / 4);  // a test that could tell
      }
    }
  }
}

TEST_CASE(
    "Neighbours and statistics of a fit are those of the mean, and alone or orphaned it is one") {
  EngineCase c = some_case(900, 5, 0.05f, true);
  for (const EngineKind engine : kEngines) {
    const Estimates fit = c.filtered(engine);
    EngineCase mean = c;
    mean.parameters.fit = BallFit::mean;
    const Estimates expected = mean.filtered(engine);
    CHECK(fit.neighbors == expected.neighbors);
    CHECK(fit.statistics.accepted == expected.statistics.accepted);
    CHECK(fit.statistics.refused == expected.statistics.refused);
    CHECK(fit.statistics.orphans == expected.statistics.orphans);
    REQUIRE(fit.statistics.orphans > 50);
    std::size_t alone = 0;
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      if (fit.neighbors[i] > 1) continue;
      CHECK(fit.c_bar[i] == expected.c_bar[i]);
      ++alone;
    }
    CHECK(alone > 100);
  }
}

// Records even in a square of side 1, or on a part of the unit sphere, of one contribution each.
template <class Light>
RecordSet lit(bool sphere, const Light& light) {
  RecordSet set(2500);
  for (std::size_t k = 0; k < set.size(); ++k) {
    const float u = (static_cast<float>(k % 50) + 0.5f) / 50;
    const float v = (static_cast<float>(k / 50) + 0.5f) / 50;
    if (sphere) {
      set.normal[k] = Vec3(u - 0.5f, 1, v - 0.5f).normalized();
      set.position[k] = set.normal[k];
    } else {
      set.position[k] = Vec3(u, 0, v);
    }
    const float l = light(set.position[k], set.normal[k]);
    set.contribution[k] = Rgb(l, 2 * l, 3 * l);
  }
  return set;
}

double error_of(const RecordSet& set, BallFit fit, EngineKind engine) {
  tests::EstimatorRun run(filter::Estimator::average);
  run.parameters.radius = {0.15, filter::RadiusBasis::world};
  run.parameters.weights = filter::WeightTerms::none();
  run.parameters.fit = fit;
  run.parameters.engine = engine;
  const Estimates result = run(set);
  double error = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    error = std::max(error, std::abs(double{result.c_bar[i].y - set.contribution[i].y}) /
                                double{set.contribution[i].y});
  }
  return error;
}

TEST_CASE("Light that is linear in place or normal stays as it is, up to the edge") {
  const RecordSet plane = lit(false, [](const Vec3& x, const Vec3&) { return 1 + x.x + 2 * x.z; });
  const RecordSet ball = lit(true, [](const Vec3&, const Vec3& n) { return 1 + n.x - 0.5f * n.z; });
  for (const RecordSet* set : {&plane, &ball}) {
    for (const EngineKind engine : kEngines) {
      CHECK(error_of(*set, BallFit::mean, engine) > 0.03);
      CHECK(error_of(*set, BallFit::linear, engine) < 0.01);
    }
  }
}

TEST_CASE("In a volume a fit is linear in all three directions") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> in(0, 1);
  RecordSet set(4000);
  for (std::size_t k = 0; k < set.size(); ++k) {
    set.position[k] = Vec3(in(random), in(random), in(random));
    set.normal[k] = Vec3(0, 0, 0);
    const Vec3& x = set.position[k];
    set.contribution[k] = Rgb(1 + x.x, 1 + x.y, 1 + x.z);
  }
  const std::vector<std::uint8_t> kind(set.size(), filter::kVolume);
  filter::Records records = set.view();
  records.kind = kind;
  const std::vector<float> radius(set.size(), 0.2f);
  for (const EngineKind engine : kEngines) {
    filter::Parameters parameters;
    parameters.engine = engine;
    const auto wrong = [&](BallFit fit) {
      parameters.fit = fit;
      const Estimates result =
          filter::estimate(records, radius, {0, 1, 1, tests::kCamera}, parameters);
      std::size_t count = 0;
      for (std::size_t i = 0; i < set.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
          const float c = set.contribution[i][k];
          count += std::abs(result.c_bar[i][k] - c) > 0.02f * c ? 1u : 0u;
        }
      }
      return count;
    };
    CHECK(wrong(BallFit::mean) > 1000);
    CHECK(wrong(BallFit::linear) == 0);
  }
}

TEST_CASE("A constant stays one, and no light becomes negative") {
  for (const EngineKind engine : kEngines) {
    EngineCase c = some_case(900, 2, 0.3f, false);
    for (Rgb& value : c.set.contribution) value = Rgb(0.1f, 7, 1e-30f);
    const Estimates constant = c.filtered(engine);
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      if (constant.neighbors[i] == 0) continue;
      CHECK(constant.c_bar[i].x == Approx(0.1).epsilon(1e-5));
      CHECK(constant.c_bar[i].y == Approx(7).epsilon(1e-5));
      CHECK(constant.c_bar[i].z == Approx(1e-30).epsilon(1e-5));
    }
    // Bright on one side, so that the fit falls below 0 on the other.
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      const bool bright = c.set.position[i].x > 0.7f;
      c.set.contribution[i] = bright ? Rgb(3e30f, 1, 1e-3f) : Rgb(0, 0, 0);
    }
    const Estimates result = c.filtered(engine);
    std::size_t black = 0;
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      for (int k = 0; k < 3; ++k) REQUIRE(result.c_bar[i][k] >= 0);
      black += result.neighbors[i] > 1 && result.c_bar[i].y == 0 ? 1u : 0u;
    }
    CHECK(black > 50);
  }
}

TEST_CASE("Layers of a fit add up, and leave the whole as it is") {
  EngineCase c = some_case(900, 6, 0.3f, false);
  for (std::size_t i = 0; i < c.set.size(); ++i) {
    if (c.set.position[i].x < 0.7f) c.set.contribution[i] = Rgb(0, 0, 0);  // some fits are cut at 0
  }
  for (const EngineKind engine : kEngines) {
    const Estimates whole = c.filtered(engine);
    const Estimates layered = tests::filtered_in_two(c, engine);
    CHECK(tests::same_bytes(layered.c_bar, whole.c_bar));
    EngineCase mean = c;
    mean.parameters.fit = BallFit::mean;
    const Estimates means = mean.filtered(engine);
    std::size_t wrong = 0, cut = 0;
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const float sum = layered.layers[0][i][k] + layered.layers[1][i][k];
        wrong += std::abs(sum - whole.c_bar[i][k]) > 1e-5f * means.c_bar[i][k] ? 1u : 0u;
        cut += whole.c_bar[i][k] < 1e-6f * means.c_bar[i][k] ? 1u : 0u;
      }
    }
    CHECK(wrong == 0);
    CHECK(cut > 4);
  }
}

TEST_CASE("A fit is the same bytes for any number of threads") {
  const EngineCase c = some_case(20'000, 9, 0.1f, true);
  const auto with_threads = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    return c.filtered(EngineKind::flann);
  };
  const Estimates one = with_threads(1);
  for (const std::size_t threads : {2u, 5u}) {
    CHECK(tests::difference(one, with_threads(threads)) == "");
  }
}

TEST_CASE("A record whose normal is not finite has no part in a fit, and is counted") {
  EngineCase c = some_case(600, 4, 0.2f, false);
  for (const std::size_t i : {17u, 40u, 300u}) c.set.normal[i] = Vec3(tests::kNan, 0, 1);
  for (const EngineKind engine : tests::kEngines) {
    const Estimates fit = c.filtered(engine);
    std::uint64_t vertices = 0;
    for (const std::size_t i : {17u, 40u, 300u}) {
      const bool has_vertex = (c.set.flags[i] & 1) != 0;
      CHECK((fit.roles[i] == filter::Role::left_out || !has_vertex));
      vertices += has_vertex ? 1u : 0u;
    }
    CHECK(vertices > 0);
    CHECK(fit.statistics.left_out == vertices);
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      for (int k = 0; k < 3; ++k) REQUIRE(std::isfinite(fit.c_bar[i][k]));
    }
  }
}

TEST_CASE("A fit is refused where no mean over a ball is taken") {
  for (const filter::Estimator estimator : tests::all_estimators()) {
    filter::Parameters parameters;
    parameters.estimator = estimator;
    parameters.fit = BallFit::linear;
    if (filter::info(estimator).fits) {
      CHECK_NOTHROW(parameters.validate());
    } else {
      CHECK_THROWS_AS(parameters.validate(), Error);
    }
  }
  CHECK(filter::info(filter::Estimator::adaptive).fits);
}

}  // namespace
}  // namespace psf
