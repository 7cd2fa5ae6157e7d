// Point sets that searches have to get right.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/vec.h"

namespace psf::tests {

struct PointSet {
  std::string name;
  std::vector<Vec3> points;
  std::vector<float> radii;  // world units, worth asking for
};

using Points = std::vector<Vec3>;

inline Points uniform_points(std::size_t count, float size, std::uint32_t seed,
                             const Vec3& offset = Vec3(0, 0, 0)) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(0, size);
  Points points(count);
  for (Vec3& p : points) {
    p = offset + Vec3(coordinate(random), coordinate(random), coordinate(random));
  }
  return points;
}

// Many points in few tight clumps, some clumps of one point repeated.
inline Points clustered_points(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  const Points centers = uniform_points(1 + count / 50, 10, seed + 1);
  std::normal_distribution<float> spread(0, 0.01f);
  Points points(count);
  for (Vec3& p : points) {
    const std::size_t c = random() % centers.size();
    p = centers[c];
    if (c % 3 != 0) p += Vec3(spread(random), spread(random), spread(random));
  }
  return points;
}

// Integer coordinates: duplicates, and distances that tie with whole radii exactly.
inline Points lattice_points(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  Points points(count);
  for (Vec3& p : points) {
    p = Vec3(static_cast<float>(random() % 7), static_cast<float>(random() % 7),
             static_cast<float>(random() % 7));
  }
  return points;
}

// On one line, spacing shrinking by half down to denormals, and back at 0.
inline Points geometric_points(std::size_t count) {
  Points points(count);
  for (std::size_t k = 0; k < count; ++k) {
    const float t = std::ldexp(1.0f, -static_cast<int>(k % 150));
    points[k] = Vec3(t, k % 2 == 0 ? t : 0, 0);
  }
  return points;
}

inline std::vector<PointSet> point_sets(std::size_t count) {
  std::vector<PointSet> sets;
  const auto add = [&sets](const char* name, Points points, std::vector<float> radii) {
    sets.push_back({name, std::move(points), std::move(radii)});
  };
  add("uniform", uniform_points(count, 1, 1), {0.01f, 0.1f, 0.3f, 2});
  add("clustered", clustered_points(count, 2), {1e-4f, 0.01f, 0.05f, 20});
  add("lattice", lattice_points(count, 3), {1, std::sqrt(2.0f), 2, 3, 5});
  add("all equal", Points(count, Vec3(0.3f, -7, 1e-3f)), {1e-20f, 1e-3f, 1});
  add("collinear, geometric", geometric_points(count), {1e-30f, 1e-19f, 1e-10f, 0.01f, 1});
  add("far away", uniform_points(count, 4, 4, Vec3(1e6f, -1e6f, 1e6f)), {0.0625f, 0.25f, 0.5f, 1});
  Points denormal = lattice_points(count, 5);
  for (Vec3& p : denormal) p *= 1e-44f;
  add("denormal", std::move(denormal), {1e-44f, 3e-23f, 1});
  Points roots = lattice_points(count, 6);  // squared distances of a few denormal steps
  for (Vec3& p : roots) p *= 1.3e-22f;
  add("denormal squares", std::move(roots), {1e-22f, 1.3e-22f, 2.6e-22f, 5e-22f});
  Points huge = uniform_points(count, 2, 7, Vec3(-1, -1, -1));
  for (Vec3& p : huge) p *= 3e38f;
  add("beyond FLANN's reach", std::move(huge), {1e18f, 3e38f});
  Points mixed = uniform_points(count, 2, 8, Vec3(-1, -1, -1));
  for (std::size_t k = 0; k < count; k += 3) mixed[k] *= 5e19f;
  add("distances that overflow", std::move(mixed), {1, 1e19f, 3e19f});
  return sets;
}

}  // namespace psf::tests
