// The fast engine finds what plain FLANN and brute force find, to the last neighbour.

#include "catch.h"
#include "engine_case.h"
#include "search/points.h"

namespace psf {
namespace {

using Kind = filter::EngineKind;
using tests::difference;
using tests::EngineCase;

constexpr unsigned kDefaultTerms = 7 + 128, kAllTerms = 255;

// Returns how many pairs passed.
std::uint64_t check(const EngineCase& c, float tolerance = 0) {
  const filter::Estimates fast = c.filtered(Kind::flann);
  CHECK(difference(fast, c.filtered(Kind::plain), tolerance) == "");
  CHECK(difference(fast, c.filtered(Kind::brute), tolerance) == "");
  return fast.statistics.accepted;
}

TEST_CASE("The engines agree whatever the number of records") {
  for (const std::size_t count :
       {1u,  2u,  3u,   4u,   5u,   15u,  16u,  17u,  31u,  32u,  33u,  63u,
        64u, 65u, 100u, 255u, 256u, 257u, 300u, 511u, 512u, 513u, 770u, 1023u}) {
    for (const unsigned terms : {0u, kDefaultTerms}) {
      for (const double unshaded : {0.0, 0.4}) {
        EngineCase c(count, static_cast<std::uint32_t>(count), unshaded);
        c.parameters.weights = tests::terms_of(terms);
        INFO(count << " records, terms " << terms << ", unshaded " << unshaded);
        check(c);
      }
    }
  }
}

TEST_CASE("The engines agree over several levels of the tree") {
  for (const std::size_t count : {4095u, 4096u, 4097u}) {
    for (const float r : {0.05f, 0.3f}) {
      EngineCase c(count, 21, 0.1);
      c.radius.assign(count, r);
      c.parameters.weights = tests::terms_of(kDefaultTerms);
      INFO(count << " records, radius " << r);
      CHECK(check(c) > count / 2);
    }
  }
}

TEST_CASE("The engines agree with every subset of terms") {
  for (unsigned bits = 0; bits < 256; ++bits) {
    EngineCase c(700, bits, bits % 2 == 0 ? 0.4 : 0);
    c.radius.assign(700, 0.4f);
    c.parameters.weights = tests::terms_of(bits);
    INFO("terms " << bits);
    CHECK(check(c) > 500);
  }
}

TEST_CASE("The engines agree on chosen sources, with neighbours enough and too few") {
  for (const std::uint32_t sources : {2u, 5u, 64u}) {
    for (const float r : {0.0f, 0.04f, 0.4f}) {
      EngineCase c(600, sources, 0.2);
      c.radius.assign(600, r);
      c.parameters.sources = sources;
      c.parameters.weights = tests::terms_of(kDefaultTerms);
      INFO("sources 1/" << sources << ", radius " << r);
      check(c);
    }
  }
}

TEST_CASE("The engines agree on disks, quotients and repetitions within rounding") {
  constexpr float kRounding = 1e-6f;
  for (const auto estimator : {filter::Estimator::average, filter::Estimator::disk}) {
    for (const bool demodulate : {false, true}) {
      for (const std::uint32_t iterations : {1u, 3u}) {
        EngineCase c(500, iterations, 0.2);
        c.parameters.weights = tests::terms_of(kDefaultTerms);
        c.parameters.estimator = estimator;
        c.parameters.demodulate = demodulate;
        c.parameters.iterations = iterations;
        INFO("demodulate " << demodulate << ", iterations " << iterations);
        check(c, kRounding);
      }
    }
  }
}

TEST_CASE("The engines agree on any radius, on one for each record too") {
  const std::vector<float> radii = {0,     1e-30f, 1e-20f, 1.0f / 64, 3.0f / 64,
                                    0.25f, 1,      1e15f,  1e30f,     tests::kInfinity};
  for (const float plane : {0.0f, 0.4f}) {  // 0 times infinity is no number, which no pair passes
    for (const unsigned terms : {0u, 16u, kDefaultTerms, kAllTerms}) {
      EngineCase c(500, 4, 0.1);
      c.parameters.weights = tests::terms_of(terms);
      if (c.parameters.weights.plane) c.parameters.weights.plane = plane;
      INFO("terms " << terms << ", plane " << plane);
      for (const float r : radii) {
        c.radius.assign(500, r);
        INFO("radius " << r);
        check(c);
      }
      for (std::size_t i = 0; i < c.radius.size(); ++i) c.radius[i] = radii[i * 7 % radii.size()];
      check(c);
    }
  }
}

// Where the radius is infinite and the term's share 0, what they allow is no number: nothing
// passes.
TEST_CASE("The engines agree in planes, where the distance from them is nothing at all") {
  for (const float plane : {0.0f, 1e-7f}) {
    EngineCase c(600, 10);
    for (std::size_t i = 0; i < c.set.size(); ++i) {
      c.set.position[i].y = i < 300 ? 0.25f : 0.75f;
      c.set.normal[i] = Vec3(0, 1, 0);
      c.radius[i] = i % 5 == 0 ? tests::kInfinity : 2.0f;
    }
    c.parameters.weights = tests::terms_of(0);
    c.parameters.weights.plane = plane;
    INFO("plane " << plane);
    CHECK(check(c) > 10'000);
  }
}

TEST_CASE("The engines agree where averages overflow and are averaged again") {
  for (const std::size_t count : {300u, 304u}) {
    EngineCase c(count, 11);
    c.set.contribution.assign(count, Rgb(3e38f, 1e38f, 1));
    c.parameters.estimator = filter::Estimator::disk;
    c.radius.assign(count, 0.5f);
    c.set.distance.assign(count, 50);
    c.parameters.iterations = 2;
    const filter::Estimates result = c.filtered(Kind::flann);
    const filter::Estimates plain = c.filtered(Kind::plain);
    std::size_t differing = 0, infinite = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float a = result.c_bar[i].x, b = plain.c_bar[i].x;
      infinite += std::isinf(b) ? 1u : 0u;
      differing += a == b || (std::isnan(a) && std::isnan(b)) ? 0u : 1u;
    }
    CHECK(infinite > count / 2);
    CHECK(differing == 0);
  }
}

TEST_CASE("The engines agree on points that are equal, in line, far away or beyond reach") {
  for (const std::size_t count : {1u, 17u, 300u}) {
    for (const tests::PointSet& points : tests::point_sets(count)) {
      for (const float r : points.radii) {
        EngineCase c(count, 5);
        c.set.position = points.points;
        c.radius.assign(count, r);
        INFO(points.name << ", " << count << " points, radius " << r);
        check(c);
        c.parameters.weights = tests::terms_of(kDefaultTerms + 16);
        check(c);
      }
    }
  }
}

// On a diagonal, the distance of two nodes' middles is all that their boxes and the radius reach;
// far from the origin, middles are rounded by more than the points are apart.
TEST_CASE("The engines agree on a diagonal far from the origin") {
  constexpr std::size_t kCount = 20'000;  // nodes enough for a search over them
  for (const float far : {0.0f, 1e5f, -1e6f}) {
    EngineCase c(kCount, 12);
    for (std::size_t i = 0; i < kCount; ++i) {
      const float t = far + static_cast<float>(i * 7919 % kCount) / 16;
      c.set.position[i] = Vec3(t, t, t);
    }
    for (const float r : {0.11f, 0.12f, 0.4f}) {
      c.radius.assign(kCount, r);
      INFO("at " << far << ", radius " << r);
      CHECK(tests::difference(c.filtered(Kind::flann), c.filtered(Kind::plain)) == "");
    }
  }
}

TEST_CASE("A record is its own neighbour where its own normal refuses it") {
  for (const float length : {0.5f, 3.0f, 1e17f, 1e25f}) {
    for (const unsigned terms : {1u, 32u, 33u, 16u, 128u, kAllTerms}) {
      EngineCase c(400, 6, 0.2);
      for (std::size_t i = 0; i < c.set.size(); ++i) {
        if (i % 3 == 0) c.set.normal[i] *= length;
        if (i % 5 == 0) c.set.direction[i] *= length;
      }
      c.parameters.weights = tests::terms_of(terms);
      INFO("length " << length << ", terms " << terms);
      check(c);
      c.radius.assign(c.radius.size(), 0);
      check(c);
    }
  }
}

TEST_CASE("The engines agree on misses and hits") {
  for (const float share : {0.0f, 0.2f, 1.0f, 1e30f}) {
    for (const unsigned every : {1u, 2u, 40u, 1000u}) {
      EngineCase c(400, 7);
      for (std::size_t i = 0; i < c.set.size(); ++i) {
        c.set.hit_distance[i] = i % every == 0 ? tests::kInfinity : static_cast<float>(i % 5);
      }
      c.parameters.weights = tests::terms_of(0);
      c.parameters.weights.hit_distance = share;
      INFO("share " << share << ", a miss in " << every);
      check(c);
    }
  }
}

TEST_CASE("The engines agree on integers whose bits are no numbers") {
  EngineCase c(500, 8);
  const std::uint32_t bits[] = {0, 1, 0x7F800000u, 0x7FC00000u, 0x80000000u, 0xFFFFFFFFu};
  for (std::size_t i = 0; i < c.set.size(); ++i) {
    c.set.visibility[i] = bits[i / 40 % std::size(bits)];
    c.set.material[i] = bits[i % std::size(bits)];
  }
  for (const unsigned terms : {4u, 64u, 68u}) {
    c.parameters.weights = tests::terms_of(terms);
    INFO("terms " << terms);
    check(c);
  }
}

TEST_CASE("The engines agree on what bad values leave") {
  EngineCase c(400, 9);
  for (std::size_t i = 0; i < c.set.size(); i += 7) c.set.position[i].y = tests::kNan;
  for (std::size_t i = 3; i < c.set.size(); i += 11) c.set.normal[i].x = tests::kInfinity;
  for (std::size_t i = 5; i < c.set.size(); i += 13) c.set.contribution[i].z = tests::kNan;
  c.parameters.weights = tests::terms_of(kAllTerms);
  check(c);
  for (Vec3& x : c.set.position) x.y = tests::kNan;
  CHECK(check(c) == 0);
}

}  // namespace
}  // namespace psf
