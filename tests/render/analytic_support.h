// Scenes built in code and estimates with standard errors, for tests against closed forms.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "catch.h"
#include "render/light/integrator.h"

namespace psf::render::test {

constexpr double kPiD = std::numbers::pi;
constexpr SamplerKind kKinds[] = {SamplerKind::sobol, SamplerKind::halton,
                                  SamplerKind::independent};

inline Rgb grey(float v) {
  return {v, v, v};
}

inline Vec3 random_direction(std::mt19937& generator) {
  std::normal_distribution<float> normal;
  return Vec3(normal(generator), normal(generator), normal(generator)).normalized();
}

inline int add_material(Scene& scene, MaterialKind kind, float reflectance, float emission = 0) {
  Material m;
  m.kind = kind;
  m.reflectance = grey(reflectance);
  m.emission = grey(emission);
  scene.materials.push_back(m);
  return static_cast<int>(scene.materials.size()) - 1;
}

// Corners o, o + u, o + u + v, o + v; front along u x v.
inline Mesh quad(const Vec3& o, const Vec3& u, const Vec3& v, int material) {
  Mesh mesh;
  mesh.positions = {o, o + u, o + u + v, o + v};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  return mesh;
}

// The floor y = 0, front up, `half` units to every side.
inline Mesh make_floor(int material, float half = 1000) {
  return quad({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}, material);
}

// Six quads facing inward, one material each.
inline void add_room(Scene& scene, const std::vector<int>& materials) {
  const Vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), low(-1, -1, -1), high(1, 1, 1);
  scene.meshes.push_back(quad(low, z, x, materials[0]));     // floor
  scene.meshes.push_back(quad(high, -x, -z, materials[1]));  // ceiling
  scene.meshes.push_back(quad(low, y, z, materials[2]));
  scene.meshes.push_back(quad(high, -z, -y, materials[3]));
  scene.meshes.push_back(quad(low, x, y, materials[4]));
  scene.meshes.push_back(quad(high, -y, -x, materials[5]));
}

inline Light point_light(const Vec3& position, float intensity) {
  Light light;
  light.position = position;
  light.intensity = grey(intensity);
  return light;
}

inline Ray ray(const Vec3& origin, const Vec3& target) {
  return {origin, (target - origin).normalized()};
}

inline Sampler sampler(SamplerKind kind, std::uint32_t sequence, std::uint64_t index) {
  SamplerSettings settings;
  settings.kind = kind;
  settings.seed = 7;
  return Sampler(settings, sequence, index);
}

inline PathRecord trace(const Integrator& integrator, const Ray& camera_ray, SamplerKind kind,
                        std::uint32_t sequence, std::uint64_t index, bool shade = true) {
  Sampler s = sampler(kind, sequence, index);
  std::uint64_t rays = 0;
  return integrator.trace(camera_ray, s, shade, rays);
}

inline Rgb pixel(const PathRecord& r) {
  return r.unfiltered + r.throughput * r.contribution;
}

struct Estimate {
  double mean, error;  // mean of the green channel, and its standard error
};

// Mean over batches that are randomised independently; their spread is the error, whatever the
// sampler.
template <class F>
Estimate batches(std::uint32_t count, F&& one) {
  double sum = 0, sum_sq = 0;
  for (std::uint32_t b = 0; b < count; ++b) {
    const double mean = one(b);
    sum += mean;
    sum_sq += mean * mean;
  }
  const double n = count, mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, sum_sq / n - mean * mean) / (n - 1))};
}

// Independent points are noisier: they get eight times the paths.
inline Estimate estimate(const Integrator& integrator, const Ray& camera_ray, SamplerKind kind,
                         std::uint64_t paths, std::uint32_t count = 32) {
  if (kind == SamplerKind::independent) paths *= 8;
  return batches(count, [&](std::uint32_t b) {
    double sum = 0;
    for (std::uint64_t i = 0; i < paths; ++i) {
      sum += double{pixel(trace(integrator, camera_ray, kind, b, i)).y};
    }
    return sum / static_cast<double>(paths);
  });
}

// Within three standard errors, and those so small that 1% off would fail. What float rounding does
// to an estimate without variance is allowed for.
inline void check(const Estimate& e, double expected) {
  CAPTURE(e.mean, e.error, expected);
  CHECK(3 * e.error <= 0.01 * expected);
  CHECK(std::abs(e.mean - expected) <= 3 * e.error + 1e-4 * expected);
}

// Of the first pass, where passes differ.
inline std::unique_ptr<const Integrator> make(const Scene& scene, const std::string& name,
                                              int max_depth = 16) {
  IntegratorSettings settings;
  settings.name = name;
  settings.max_depth = max_depth;
  settings.photon_paths = 1024;
  std::unique_ptr<const Integrator> integrator = make_integrator(scene, settings);
  std::uint64_t rays = 0;
  auto of_pass = integrator->for_pass({}, 0, rays);
  return of_pass != nullptr ? std::move(of_pass) : std::move(integrator);
}

}  // namespace psf::render::test
