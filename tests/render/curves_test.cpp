// Curves: rays meet them where closed forms, and the distance to their balls by brute force, say.
#include <random>

#include "analytic_support.h"
#include "load_support.h"
#include "render/accel/accel.h"
#include "render/light/surface.h"
#include "render/scene/load_parts.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

using Imath::V3d;

Vec3 some_direction(std::mt19937& generator) {
  std::normal_distribution<float> normal;
  return Vec3(normal(generator), normal(generator), normal(generator)).normalized();
}

Scene curve(const std::vector<CurvePoint>& points) {
  Scene scene;
  add_material(scene, MaterialKind::diffuse, 0.5f);
  Curves curves;
  curves.points = points;
  for (std::uint32_t k = 0; k + 1 < points.size(); ++k) curves.segments.push_back(k);
  scene.curves.push_back(curves);
  return scene;
}

// The signed distance from the balls along all segments, by many of them.
double outside(const std::vector<CurvePoint>& points, const V3d& p) {
  double least = 1e300;
  constexpr int kBalls = 4000;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const V3d from(points[i].position), to(points[i + 1].position);
    for (int k = 0; k <= kBalls; ++k) {
      const double t = static_cast<double>(k) / kBalls;
      const double radius = double{points[i].radius} * (1 - t) + double{points[i + 1].radius} * t;
      least = std::min(least, (p - (from * (1 - t) + to * t)).length() - radius);
    }
  }
  return least;
}

// As a scene file, of a straight strand.
std::string strand(const std::string& more, const std::string& material = "white") {
  return R"({"shape": "curves", "material": ")" + material +
         R"(", "strands": [[[0, 0, 0, 0.1], [0, 1, 0, 0.1], [0, 3, 0, 0]]])" + more + "}";
}

}  // namespace

TEST_CASE("A straight curve is a cylinder: distance and normal by the closed form") {
  const float radius = GENERATE(0.5f, 0.01f);
  std::vector<CurvePoint> points;
  for (int k = 0; k <= 10; ++k)
    points.push_back({Vec3(1, 2, -5.0f + static_cast<float>(k)), radius});
  const Scene scene = curve(points);
  const Accel accel(scene);
  const Shapes shapes(scene);
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> across(-1.5f, 1.5f), along(-4, 4);
  int met = 0, missed = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 eye = Vec3(1, 2, along(generator)) + some_direction(generator) * 5.0f;
    const Vec3 target(1 + across(generator) * radius, 2 + across(generator) * radius,
                      along(generator));
    const Ray r = ray(eye, target);
    // |eye + t d - axis| = radius in x and y, in double.
    const double ox = double{eye.x} - 1, oy = double{eye.y} - 2, dx = double{r.direction.x},
                 dy = double{r.direction.y}, a = dx * dx + dy * dy, b = ox * dx + oy * dy,
                 c = ox * ox + oy * oy - double{radius} * double{radius};
    if (c < 0 || a < 0.01) continue;
    const double root = b * b - a * c;
    Hit hit;
    const bool found = accel.intersect(r.origin, r.direction, hit);
    if (std::abs(root) < 1e-4 * b * b * double{radius}) continue;  // a tangent
    const double t = (-b - std::sqrt(std::max(root, 0.0))) / a;
    const double z = double{eye.z} + t * double{r.direction.z};
    if (root > 0 && (t < 0 || std::abs(z) > 5)) continue;  // behind, or near the ends
    if (root < 0) {
      CHECK_FALSE(found);
      ++missed;
      continue;
    }
    REQUIRE(found);
    ++met;
    REQUIRE(double{hit.distance} == Approx(t).epsilon(2e-4));
    const Surface s = shapes.surface(hit, r.direction);
    const Vec3 normal(static_cast<float>((ox + t * dx) / double{radius}),
                      static_cast<float>((oy + t * dy) / double{radius}), 0);
    REQUIRE(std::sqrt(length_sq(s.normal - normal)) < 2e-2f);
    REQUIRE(s.normal.z == Approx(0).margin(1e-4));
    REQUIRE(length_sq(s.normal) == Approx(1));
    REQUIRE(s.front);
    REQUIRE(s.on_curve);
    const double off = std::hypot(double{s.position.x} - 1, double{s.position.y} - 2);
    REQUIRE(std::abs(off - double{radius}) < 1e-6);
    REQUIRE(double{s.position.z} == Approx(z).margin(1e-4));
  }
  CHECK(met > 3000);
  CHECK(missed > 1000);
}

TEST_CASE("A curve that bends and tapers is met on the hull of its balls, and nothing before it") {
  const std::vector<CurvePoint> points = {{{0, 0, 0}, 0.3f},
                                          {{0.2f, 1, 0.1f}, 0.2f},
                                          {{0.9f, 1.6f, 0.3f}, 0.25f},
                                          {{1.9f, 1.5f, -0.4f}, 0.02f}};
  const Scene scene = curve(points);
  const Accel accel(scene);
  const Shapes shapes(scene);
  std::mt19937 generator(2);
  int met = 0;
  for (int k = 0; k < 300; ++k) {
    const Ray r = ray(Vec3(0.8f, 0.9f, 0) + some_direction(generator) * 3.0f,
                      Vec3(0.7f, 1, 0) + some_direction(generator) * 0.7f);
    Hit hit;
    const bool found = accel.intersect(r.origin, r.direction, hit);
    const double end = found ? double{hit.distance} - 1e-3 : 6;
    double nearest = 1e300;
    for (double t = 0; t < end;) {
      const double step = outside(points, V3d(r.origin) + V3d(r.direction) * t);
      nearest = std::min(nearest, step);
      t += std::max(step, 1e-3);
    }
    REQUIRE(nearest > (found ? -1e-4 : -1e-3));
    if (!found) continue;
    ++met;
    const Surface s = shapes.surface(hit, r.direction);
    REQUIRE(std::abs(outside(points, V3d(s.position))) < 1e-5);
    // The normal is where the distance grows.
    const double step = 1e-3;
    const double grown = outside(points, V3d(s.position) + V3d(s.normal) * step);
    REQUIRE(grown == Approx(step).epsilon(0.02));
  }
  CHECK(met > 60);
}

TEST_CASE("A curve covers the area of its outline") {
  const float radius = GENERATE(0.1f, 0.002f);
  const Scene scene = curve({{{-1, 0, 0}, radius}, {{0, 0, 0}, radius}, {{1, 0, 0}, radius}});
  const Accel accel(scene);
  std::mt19937 generator(3);
  const float height = 2 * radius;
  std::uniform_real_distribution<float> x(-1.5f, 1.5f), y(-height, height);
  int met = 0;
  constexpr int kRays = 200000;
  for (int k = 0; k < kRays; ++k) {
    if (accel.occluded({x(generator), y(generator), 9}, {0, 0, -1}, 100)) ++met;
  }
  const double r = double{radius}, share = (4 * r + kPiD * r * r) / (3 * 4 * r);
  CHECK(static_cast<double>(met) / kRays == Approx(share).margin(0.006));
}

TEST_CASE("A ray that leaves a curve does not meet it again") {
  std::mt19937 generator(4);
  const float thickness = GENERATE(1e-3f, 0.1f);
  const float place = GENERATE(0.0f, 1.0f, 10.0f);
  int again = 0, met = 0;
  for (int k = 0; k < 30; ++k) {
    const Vec3 where = some_direction(generator) * place, axis = some_direction(generator);
    std::vector<CurvePoint> points;
    for (int i = 0; i <= 6; ++i)
      points.push_back({where + axis * (0.1f * static_cast<float>(i)), thickness});
    const Scene scene = curve(points);
    const Accel accel(scene);
    const Shapes shapes(scene);
    for (int r = 0; r < 1000; ++r) {
      const Vec3 target = where + axis * (0.0006f * static_cast<float>(r)) +
                          some_direction(generator) * (0.8f * thickness);
      const Vec3 eye = target + some_direction(generator);
      const Vec3 direction = (target - eye).normalized();
      Hit hit;
      if (!accel.intersect(eye, direction, hit)) continue;
      const Surface s = shapes.surface(hit, direction);
      if (!s.front) continue;
      ++met;
      Vec3 away = some_direction(generator);
      if (dot(away, s.geometric_normal) < 0) away = -away;
      if (r % 2 == 0)
        away = (away - s.geometric_normal * (0.99f * dot(away, s.geometric_normal))).normalized();
      if (accel.occluded(s.origin_toward(away), away, 1e30f)) ++again;
    }
  }
  CHECK(met > 10000);
  CHECK(again == 0);
}

TEST_CASE("Records tell vertices on curves from those on surfaces") {
  Scene scene = curve({{{0, 0, 0}, 0.2f}, {{0, 1, 0}, 0.2f}});
  scene.meshes.push_back(quad({-5, -5, -1}, {10, 0, 0}, {0, 10, 0}, 0));
  scene.environment.radiance = grey(1);
  const auto integrator = make(scene, "path");
  const PathRecord on_curve =
      trace(*integrator, ray({0, 0.5f, 5}, {0, 0.5f, 0}), SamplerKind::sobol, 0, 0);
  CHECK(on_curve.kind == VertexKind::curve);
  CHECK(on_curve.distance == Approx(4.8));
  CHECK(on_curve.position.z == Approx(0.2));
  const PathRecord beside =
      trace(*integrator, ray({2, 0.5f, 5}, {2, 0.5f, 0}), SamplerKind::sobol, 0, 0);
  CHECK(beside.kind == VertexKind::surface);
}

TEST_CASE("A white curve in a white furnace is not seen") {
  Scene scene = curve({{{0, 0, 0}, 0.2f}, {{0.3f, 1, 0}, 0.1f}, {{0.9f, 1.2f, 0.3f}, 0.05f}});
  scene.materials[0].reflectance = grey(1);
  scene.environment.radiance = grey(1);
  const auto integrator = make(scene, "path", 64);
  check(estimate(*integrator, ray({0.1f, 0.5f, 5}, {0.1f, 0.5f, 0}), SamplerKind::sobol, 256), 1);
}

TEST_CASE("Strands of a scene file become curves through their points", "[load][json]") {
  const TempFolder folder;
  const auto load = [&](const std::string& shape) {
    return load_scene(folder.write("s.json", with_shapes(shape)));
  };
  const auto message = [&](const std::string& shape) {
    return load_failure(folder.write("s.json", with_shapes(shape))).message;
  };
  const Scene plain = load(strand(R"(, "segments": 1)"));
  REQUIRE(plain.curves.size() == 1);
  CHECK(plain.curves[0].points.size() == 3);
  CHECK(plain.curves[0].segments == std::vector<std::uint32_t>{0, 1});
  const Scene fine = load(strand(
      R"(, "segments": 4, "transform": [{"scale": 2}, {"rotate": 90, "axis": "z"}],
         "repeat": {"count": 3, "step": {"translate": [0, 0, 5]}})"));
  REQUIRE(fine.curves[0].points.size() == 27);
  CHECK(fine.curves[0].segments.size() == 24);
  CHECK(fine.curves[0].segments[8] == 9);  // nothing joins one strand to the next
  check_point(fine.curves[0].points[4].position, {-2, 0, 0});
  CHECK(fine.curves[0].points[4].radius == Approx(0.2));
  check_point(fine.curves[0].points[26].position, {-6, 0, 10});
  for (const CurvePoint& p : fine.curves[0].points) CHECK(std::abs(p.position.y) < 1e-5f);
  check_point(load(strand("")).cameras.at(0).target, {0, 1.45f, 0});
  CHECK(hash_of(plain) != hash_of(fine));

  CHECK(contains(message(strand(R"(, "transform": {"scale": [1, 2, 1]})")),
                 "/shapes/0: curves can be moved, turned and scaled evenly only"));
  CHECK(contains(message(strand("", "lamp")),
                 "curves are neither glass nor lights, as the material lamp is"));
  CHECK(
      contains(message(R"({"shape": "curves", "material": "white", "strands": [[[0, 0, 0, 1]]]})"),
               "/shapes/0/strands/0: expected at least two points"));
  CHECK(contains(message(R"({"shape": "curves", "material": "white",
                             "strands": [[[0, 0, 0, 1], [0, 0, 0, 1]]]})"),
                 "/shapes/0/strands/0/1: is the same point as the one before"));
  CHECK(contains(message(R"({"shape": "curves", "material": "white",
                             "strands": [[[0, 0, 0, 1], [0, 0, 1, -1]]]})"),
                 "expected three coordinates and a radius >= 0"));
}
