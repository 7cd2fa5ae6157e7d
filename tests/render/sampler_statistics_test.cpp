// Samplers: uniform, independent where they should be, reproducible, and better than chance.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "catch.h"
#include "render/sample/sampler.h"
#include "render/sample/sampler_hash.h"

using namespace psf;
using namespace psf::render;

namespace {

constexpr std::array kKinds{SamplerKind::sobol, SamplerKind::halton, SamplerKind::independent};
constexpr std::array kEnumerations{Enumeration::pixel, Enumeration::global};

// Pearson's statistic of equally likely cells, as a normal deviate (for many cells).
double chi_sq_deviate(const std::vector<int>& counts, double total) {
  const double expected = total / static_cast<double>(counts.size());
  double sum = 0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  const double freedom = static_cast<double>(counts.size()) - 1;
  return (sum - freedom) / std::sqrt(2 * freedom);
}

float dimension_of(Sampler sampler, int dimension) {
  for (int k = 0; k < dimension; ++k) (void)sampler.next_1d();
  return sampler.next_1d();
}

}  // namespace

TEST_CASE("numbers are from 0 to below 1, also the largest") {
  CHECK(to_unit(0xffffffffu) < 1.0f);
  CHECK(to_unit(0) == 0.0f);
  for (const SamplerKind kind : kKinds) {
    for (const Enumeration enumeration : kEnumerations) {
      float least = 1;
      float most = 0;
      for (std::uint64_t i = 0; i < 3000; ++i) {
        Sampler sampler({kind, enumeration, 4}, 1, i * i * 77);
        for (int d = 0; d < 150; ++d) {
          const float u = sampler.next_1d();
          least = std::min(least, u);
          most = std::max(most, u);
        }
      }
      CHECK(least >= 0.0f);
      CHECK(most < 1.0f);
      CHECK(least < 1e-4f);
      CHECK(most > 1 - 1e-4f);
    }
  }
}

TEST_CASE("over the seeds, every coordinate of every point is uniform") {
  constexpr int kSeeds = 16384;
  for (const SamplerKind kind : kKinds) {
    for (const Enumeration enumeration : kEnumerations) {
      for (const std::uint64_t index : {std::uint64_t{0}, std::uint64_t{12345}}) {
        for (const int dimension : {0, 1, 5, 140}) {
          std::vector<int> counts(128, 0);
          double sum = 0;
          double sum_sq = 0;
          for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            const Sampler sampler({kind, enumeration, seed}, 3, index);
            const double u = double{dimension_of(sampler, dimension)};
            ++counts[static_cast<std::size_t>(u * 128)];
            sum += u;
            sum_sq += u * u;
          }
          const double mean = sum / kSeeds;
          CHECK(std::abs(mean - 0.5) < 5 * std::sqrt(1 / 12.0 / kSeeds));
          CHECK(std::abs(sum_sq / kSeeds - 1 / 3.0) < 5 * std::sqrt(4 / 45.0 / kSeeds));
          CHECK(std::abs(chi_sq_deviate(counts, kSeeds)) < 5);
        }
      }
    }
  }
}

TEST_CASE("dimensions, seeds, pixels and continuations are independent of each other") {
  // Cells of 8 x 8 values of a pair of numbers that must know nothing of each other.
  constexpr int kTrials = 16384;
  const auto check = [&](const auto& pair) {
    std::vector<int> counts(64, 0);
    for (std::uint64_t t = 0; t < kTrials; ++t) {
      const std::pair<float, float> u = pair(t);
      ++counts[static_cast<std::size_t>(u.first * 8) * 8 + static_cast<std::size_t>(u.second * 8)];
    }
    CHECK(std::abs(chi_sq_deviate(counts, kTrials)) < 5);
  };
  for (const SamplerKind kind : kKinds) {
    for (const Enumeration enumeration : kEnumerations) {
      const auto at = [=](std::uint64_t seed, std::uint32_t sequence, std::uint64_t index) {
        return Sampler({kind, enumeration, seed}, sequence, index);
      };
      // Two dimensions over the seeds.
      for (const int dimension : {1, 2, 7, 130}) {
        check([&](std::uint64_t t) {
          const Sampler sampler = at(t, 0, 9);
          return std::pair(dimension_of(sampler, 0), dimension_of(sampler, dimension));
        });
      }
      // The same point of seeds and of pixels that follow each other.
      check([&](std::uint64_t t) {
        return std::pair(dimension_of(at(2 * t, 0, 3), 0), dimension_of(at(2 * t + 1, 0, 3), 0));
      });
      check([&](std::uint64_t t) {
        const auto pixel = static_cast<std::uint32_t>(2 * t);
        return std::pair(dimension_of(at(7, pixel, 3), 1), dimension_of(at(7, pixel + 1, 3), 1));
      });
      // A path and its continuation, at the dimension where they part.
      check([&](std::uint64_t t) {
        Sampler path = at(t, 0, 6);
        (void)path.next_2d();
        return std::pair(dimension_of(path, 0), dimension_of(path.split(0, 1), 0));
      });
    }
  }
}

TEST_CASE("along one sequence, image plane and continuations fill their product space") {
  // A pad that repeats another, or a split that restarts the sequence, leaves most cells empty.
  constexpr int kPoints = 4096;
  for (const SamplerKind kind : kKinds) {
    for (const Enumeration enumeration : kEnumerations) {
      for (const std::uint32_t count : {0u, 1u, 4u}) {  // 0: the path itself
        std::vector<int> cells(64, 0);
        for (std::uint64_t i = 0; i < kPoints; ++i) {
          Sampler path({kind, enumeration, 11}, 5, i);
          const Vec2 plane = path.next_2d();
          Sampler next =
              count == 0 ? path : path.split(static_cast<std::uint32_t>(i) % count, count);
          const float u = next.next_2d().x;
          ++cells[static_cast<std::size_t>(plane.x * 8) * 8 + static_cast<std::size_t>(u * 8)];
        }
        CHECK(chi_sq_deviate(cells, kPoints) < 4);
      }
    }
  }
}

TEST_CASE("a number depends on seed, sequence, index and dimension alone") {
  for (const SamplerKind kind : kKinds) {
    for (const Enumeration enumeration : kEnumerations) {
      const SamplerSettings settings{kind, enumeration, 42};
      Sampler a(settings, 8, 1000);
      (void)Sampler(settings, 9, 1001).next_2d();
      Sampler b(settings, 8, 1000);
      for (int k = 0; k < 100; ++k) CHECK(a.next_2d() == b.next_2d());
      const Sampler c = a;
      CHECK(c.split(2, 4).next_1d() == a.split(2, 4).next_1d());
      CHECK(dimension_of(c.split(2, 4), 0) != dimension_of(c.split(3, 4), 0));
      Sampler other({kind, enumeration, 43}, 8, 1000);
      CHECK(Sampler(settings, 8, 1000).next_2d() != other.next_2d());
    }
  }
}

TEST_CASE("the error of a smooth integral falls like n^-1.5 scrambled and n^-0.5 independent") {
  // f = exp(x + y) over the unit square.
  const double exact = std::pow(std::exp(1.0) - 1, 2);
  const auto slope = [&](SamplerKind kind, Enumeration enumeration) {
    std::vector<double> x;
    std::vector<double> y;
    for (int m = 4; m <= 12; m += 2) {
      const std::uint64_t n = std::uint64_t{1} << m;
      double error_sq = 0;
      constexpr std::uint64_t kSeeds = 48;
      for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        double sum = 0;
        for (std::uint64_t i = 0; i < n; ++i) {
          const Vec2 u = Sampler({kind, enumeration, seed}, 0, i).next_2d();
          sum += std::exp(double{u.x} + double{u.y});
        }
        error_sq += std::pow(sum / static_cast<double>(n) - exact, 2);
      }
      x.push_back(m);
      y.push_back(0.5 * std::log2(error_sq / kSeeds));
    }
    double xy = 0;
    double xx = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      xy += (x[k] - 8) * y[k];
      xx += (x[k] - 8) * (x[k] - 8);
    }
    return xy / xx;
  };
  for (const Enumeration enumeration : kEnumerations) {
    CHECK(slope(SamplerKind::sobol, enumeration) == Approx(-1.45).margin(0.15));
    CHECK(slope(SamplerKind::halton, enumeration) == Approx(-1.2).margin(0.25));
    CHECK(slope(SamplerKind::independent, enumeration) == Approx(-0.5).margin(0.1));
  }
}
