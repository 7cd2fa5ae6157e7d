// Samplers: the nets they promise, checked by counting points in elementary intervals.
#include "render/sample/sampler.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "catch.h"
#include "render/sample/halton.h"
#include "render/sample/sampler_hash.h"
#include "render/sample/sobol.h"

using namespace psf;
using namespace psf::render;

namespace {

using Points = std::vector<Vec2>;

// Draws the pair of dimensions (skip, skip + 1) of `count` points from `first` on.
Points draw(const SamplerSettings& settings, std::uint32_t sequence, std::uint64_t first,
            std::size_t count, int skip) {
  Points points;
  for (std::uint64_t i = first; i < first + count; ++i) {
    Sampler sampler(settings, sequence, i);
    for (int k = 0; k < skip; ++k) (void)sampler.next_1d();
    points.push_back(sampler.next_2d());
  }
  return points;
}

// Whether each of nx * ny equal boxes holds exactly one of the nx * ny points.
bool one_a_box(const Points& points, std::size_t nx, std::size_t ny) {
  std::vector<int> count(nx * ny, 0);
  for (const Vec2& p : points) {
    const auto x = static_cast<std::size_t>(double{p.x} * static_cast<double>(nx));
    const auto y = static_cast<std::size_t>(double{p.y} * static_cast<double>(ny));
    if (x >= nx || y >= ny || ++count[y * nx + x] > 1) return false;
  }
  return points.size() == nx * ny;
}

// Whether each of n = values.size() equal intervals holds exactly one value. A float stands for
// [x, x + 2^-24): where that holds the end of an interval, either side will do.
bool one_an_interval(const std::vector<float>& values) {
  const auto n = static_cast<double>(values.size());
  std::vector<int> count(values.size() + 1, 0);
  std::vector<std::size_t> either;
  for (const float x : values) {
    const auto from = static_cast<std::size_t>(double{x} * n);
    const auto to = static_cast<std::size_t>((double{x} + 0x1p-24) * n);
    if (from == to) {
      ++count[from];
    } else {
      either.push_back(from);
    }
  }
  for (const std::size_t k : either) ++count[count[k] == 0 ? k : k + 1];
  return std::all_of(count.begin(), count.end() - 1, [](int k) { return k == 1; });
}

// (0, m, 2)-net in base 2: one point in every elementary interval of every shape.
bool is_net(const Points& points) {
  for (std::size_t nx = 1; nx <= points.size(); nx *= 2) {
    if (!one_a_box(points, nx, points.size() / nx)) return false;
  }
  return true;
}

// Blocks near and far, past 2^32 and near 2^40.
std::vector<std::uint64_t> block_starts(std::uint64_t size) {
  return {0, size, 7 * size, (std::uint64_t{1} << 33) + 3 * size, (std::uint64_t{1} << 40) - size};
}

}  // namespace

TEST_CASE("sobol, global: the image plane of every aligned block of 2^m paths is a (0,m,2)-net") {
  for (const std::uint64_t seed : {0u, 1u, 77u}) {
    const SamplerSettings settings{SamplerKind::sobol, Enumeration::global, seed};
    for (std::uint64_t m = 0; m <= 11; ++m) {
      const std::uint64_t size = std::uint64_t{1} << m;
      for (const std::uint64_t first : block_starts(size)) {
        CHECK(is_net(draw(settings, 0, first, size, 0)));
      }
    }
  }
}

TEST_CASE("sobol, pixel: every pair of dimensions of a pixel's aligned passes is a (0,m,2)-net") {
  const SamplerSettings settings{SamplerKind::sobol, Enumeration::pixel, 5};
  for (const std::uint32_t pixel : {0u, 1u, 4000000000u}) {
    for (const int skip : {0, 2, 3, 40, 500}) {
      for (std::uint64_t m = 0; m <= 8; m += 2) {
        const std::uint64_t size = std::uint64_t{1} << m;
        for (const std::uint64_t first : block_starts(size)) {
          CHECK(is_net(draw(settings, pixel, first, size, skip)));
        }
      }
    }
  }
}

TEST_CASE("sobol, global: pairs past the 128 dimensions of the table are nets too") {
  const SamplerSettings settings{SamplerKind::sobol, Enumeration::global, 5};
  for (const int skip : {127, 128, 131}) CHECK(is_net(draw(settings, 0, 4096, 1024, skip)));
}

TEST_CASE("a set that is no net is told from one") {
  Points points = draw({SamplerKind::sobol, Enumeration::global, 1}, 0, 0, 64, 0);
  points[10] = points[11];
  CHECK_FALSE(is_net(points));
  // Half of one aligned block and half of the next.
  CHECK_FALSE(is_net(draw({SamplerKind::sobol, Enumeration::global, 1}, 0, 32 + 7, 64, 0)));
  CHECK_FALSE(is_net(draw({SamplerKind::independent, Enumeration::global, 1}, 0, 0, 64, 0)));
}

TEST_CASE("every dimension of sobol stratifies every aligned block of 2^m points") {
  for (const Enumeration enumeration : {Enumeration::global, Enumeration::pixel}) {
    const SamplerSettings settings{SamplerKind::sobol, enumeration, 9};
    constexpr std::size_t kSize = 256;
    for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{1} << 20}) {
      std::vector<Sampler> samplers;
      for (std::size_t i = 0; i < kSize; ++i) samplers.emplace_back(settings, 3u, first + i);
      for (int dimension = 0; dimension < 140; ++dimension) {
        Points points;
        for (Sampler& sampler : samplers) points.emplace_back(sampler.next_1d(), 0.0f);
        CHECK(one_a_box(points, kSize, 1));
      }
    }
  }
}

TEST_CASE("sobol's dimensions have Sobol's property A") {
  // The leading rows of the first s matrices, s columns of them, are independent modulo 2: the
  // first 2^s points lie one in each of the 2^s half-cubes. Joe and Kuo's numbers are chosen so.
  std::vector<std::uint64_t> rows;
  for (std::uint32_t s = 1; s <= kSobolIndexBits; ++s) {
    std::uint64_t row = 0;
    for (int j = 0; j < kSobolIndexBits; ++j) {
      row |= std::uint64_t{sobol_reversed(std::uint64_t{1} << j, s - 1) & 1u} << j;
    }
    rows.push_back(row);
    std::vector<std::uint64_t> left = rows;
    std::uint32_t rank = 0;
    for (std::uint32_t column = 0; column < s; ++column) {
      const auto has_bit = [column](std::uint64_t r) { return (r >> column & 1) != 0; };
      const auto pivot = std::find_if(left.begin() + rank, left.end(), has_bit);
      if (pivot == left.end()) continue;
      std::swap(*pivot, left[rank]);
      for (std::size_t k = rank + 1; k < left.size(); ++k) {
        if (has_bit(left[k])) left[k] ^= left[rank];
      }
      ++rank;
    }
    CHECK(rank == s);
  }
}

TEST_CASE("the table of numbers is the published one") {
  // FNV-1a over it, taken when every point of 5,000 agreed with another implementation's.
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const SobolNumbers& numbers : kSobolNumbers) {
    hash = (hash ^ numbers.polynomial) * 0x100000001b3u;
    for (const std::uint16_t m : numbers.m) hash = (hash ^ m) * 0x100000001b3u;
  }
  CHECK(hash == 0x1c3991e53e9bb31fu);
}

TEST_CASE("the table-free second dimension is the table's") {
  for (std::uint64_t index = 0; index < 5000; ++index) {
    const auto x = static_cast<std::uint32_t>(index * 2654435761u);
    CHECK(sobol_reversed_1(x) == sobol_reversed(x, 1));
    CHECK(reverse_bits(sobol_reversed(x, 0)) == reverse_bits(x));
  }
}

TEST_CASE("every dimension of halton stratifies every aligned block of b^m points") {
  for (const std::uint32_t dimension : {0u, 1u, 2u, 3u, 4u, 9u, 30u, 127u}) {
    const std::uint32_t base = halton_base(dimension);
    for (std::uint64_t size = base; size <= 2500; size *= base) {
      for (const std::uint64_t block :
           {std::uint64_t{0}, std::uint64_t{5}, std::uint64_t{1} << 26}) {
        std::vector<float> values;
        for (std::uint64_t i = 0; i < size; ++i) {
          values.push_back(halton(block * size + i, dimension, 1234));
        }
        CHECK(one_an_interval(values));
      }
    }
  }
  CHECK(halton_base(0) == 2);
  CHECK(halton_base(1) == 3);
  CHECK(halton_base(127) == 719);
}

TEST_CASE("halton's image plane: one point in each of 2^a 3^b boxes for aligned 2^a 3^b points") {
  const SamplerSettings settings{SamplerKind::halton, Enumeration::global, 3};
  for (const auto& [nx, ny] : {std::pair{8, 9}, {16, 3}, {4, 81}, {1, 27}}) {
    const auto size = static_cast<std::size_t>(nx * ny);
    for (const std::uint64_t block : {0u, 1u, 1000u}) {
      const Points points = draw(settings, 0, block * size, size, 0);
      CHECK(one_a_box(points, static_cast<std::size_t>(nx), static_cast<std::size_t>(ny)));
    }
  }
}

TEST_CASE("the points of all continuations of aligned paths together are stratified") {
  constexpr std::uint32_t kPaths = 32;
  constexpr std::uint32_t kCount = 8;
  for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::halton}) {
    for (const Enumeration enumeration : {Enumeration::pixel, Enumeration::global}) {
      const bool halton = kind == SamplerKind::halton;
      Points points;
      for (std::uint64_t i = 0; i < kPaths; ++i) {
        Sampler path({kind, enumeration, 2}, 0, 3 * kPaths + i);
        if (!halton) (void)path.next_2d();
        for (std::uint32_t k = 0; k < kCount; ++k) {
          points.emplace_back(path.split(k, kCount).next_1d(), 0.0f);
        }
      }
      CHECK(one_a_box(points, kPaths * kCount, 1));
    }
  }
}
