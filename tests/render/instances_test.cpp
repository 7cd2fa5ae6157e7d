// Instances: rays meet them where their meshes, placed in double, would be; and which copies they are.
#include <random>

#include "analytic_support.h"
#include "load_support.h"
#include "render/accel/accel.h"
#include "render/light/surface.h"
#include "render/scene/load_parts.h"
#include "render/scene/procedural/procedural.h"
#include "render/scene/shapes.h"

using namespace psf;
using namespace psf::render;
using namespace psf::render::test;

namespace {

// A closed body of radius 1 about the origin, with folds.
Mesh body(bool normals) {
  NoiseSphere sphere;
  sphere.amplitude = 0.3;
  sphere.segments = 8;
  Mesh mesh = make_noise_sphere(sphere);
  if (!normals) mesh.normals.clear();
  return mesh;
}

Imath::M44d turned(const Imath::V3d& axis, double angle) {
  return Imath::M44d().setAxisAngle(axis.normalized(), angle);
}
Imath::M44d scaled(const Imath::V3d& by) {
  return Imath::M44d().setScale(by);
}
Imath::M44d moved(const Imath::V3d& by) {
  return Imath::M44d().setTranslation(by);
}

Scene instance_of(const Mesh& mesh, const Imath::M44d& placement) {
  Scene scene;
  add_material(scene, MaterialKind::diffuse, 0.5f);
  scene.prototypes.push_back(mesh);
  scene.instances.push_back({0, Mat4(placement)});
  return scene;
}

std::string lathes(int segments, const std::string& material, const std::string& repeat) {
  return R"({"shape": "lathe", "profile": [[0, 0], [1, 0.5], [0.5, 1], [0, 1.2]], "material": ")" +
         material + R"(", "segments": )" + std::to_string(segments) + R"(, "repeat": )" + repeat +
         "}";
}

}  // namespace

TEST_CASE("An instance is met where its mesh would be, placed in double") {
  const bool normals = GENERATE(true, false);
  const Imath::M44d placement =
      GENERATE(turned({1, 2, 3}, 1.1) * moved({3, -2, 5}), scaled({1, 1, -1}) * moved({0, 4, 0}),
               scaled({0.3, 2, 1}) * turned({0, 1, 1}, 0.7) * moved({-7, 1, 0}),
               Imath::M44d(1, 0.4, 0, 0, 0, 0.8, 0.3, 0, -0.5, 0, 1.2, 0, 40, 20, -30, 1));
  const Mesh mesh = body(normals);
  const Scene as_instance = instance_of(mesh, placement);
  Scene as_mesh;
  add_material(as_mesh, MaterialKind::diffuse, 0.5f);
  as_mesh.meshes.push_back(mesh);
  transform(as_mesh.meshes[0], placement);
  const Accel instance_accel(as_instance), mesh_accel(as_mesh);
  const Shapes instance_shapes(as_instance), mesh_shapes(as_mesh);
  CHECK(double{length_sq(instance_accel.center() - mesh_accel.center())} < 1);
  const Vec3 center(placement.translation());
  std::mt19937 generator(1);
  int met = 0, odd = 0;
  for (int k = 0; k < 5000; ++k) {
    const Vec3 eye = center + random_direction(generator) * 6.0f;
    const Ray r = ray(eye, center + random_direction(generator) * 0.9f);
    Hit a, b;
    const bool on_instance = instance_accel.intersect(r.origin, r.direction, a);
    const bool on_mesh = mesh_accel.intersect(r.origin, r.direction, b);
    CHECK(instance_accel.occluded(r.origin, r.direction, 100) == on_instance);
    // Roundings decide at silhouettes, and between neighbours.
    if (on_instance != on_mesh || a.primitive != b.primitive) {
      ++odd;
      continue;
    }
    if (!on_mesh) continue;
    ++met;
    const Surface s = instance_shapes.surface(a, r.direction);
    const Surface t = mesh_shapes.surface(b, r.direction);
    // Along the surface a ray's roundings are many times as long.
    if (std::abs(dot(t.geometric_normal, r.direction)) < 0.1f) continue;
    REQUIRE(a.instance == 0);
    REQUIRE(double{a.distance} == Approx(double{b.distance}).epsilon(1e-4));
    REQUIRE(std::sqrt(length_sq(s.position - t.position)) < 1e-4f);
    REQUIRE(std::sqrt(length_sq(s.geometric_normal - t.geometric_normal)) < 1e-4f);
    if (normals) {
      const auto& corners = mesh.triangles[a.primitive];
      const Vec3 mean = mesh.normals[corners[0]] * (1 - a.u - a.v) +
                        mesh.normals[corners[1]] * a.u + mesh.normals[corners[2]] * a.v;
      Imath::V3d placed;
      placement.inverse().transposed().multDirMatrix(Imath::V3d(mean), placed);
      Vec3 expected(placed.normalized());
      if (dot(expected, s.geometric_normal) < 0) expected = -expected;
      // Else it is bent into sight.
      if (dot(expected, r.direction) < -0.01f) {
        REQUIRE(std::sqrt(length_sq(s.normal - expected)) < 1e-4f);
      }
    }
    REQUIRE(std::abs(s.uv.x - t.uv.x) + std::abs(s.uv.y - t.uv.y) < 1e-3f);
    REQUIRE(s.front == t.front);
    REQUIRE((s.normal == s.geometric_normal) == (t.normal == t.geometric_normal));
  }
  CHECK(met > 1500);
  CHECK(odd < 10);
}

TEST_CASE("A ray that leaves an instance does not meet it again; one into it meets its far side") {
  std::mt19937 generator(2);
  const float scale = GENERATE(1e-3f, 1.0f, 1e3f);
  const float place = GENERATE(0.0f, 1.0f, 100.0f);
  const double stretch = GENERATE(1.0, 10.0);
  const Mesh box = make_box(Vec3(-1), Vec3(1));
  int again = 0, lost = 0, met = 0;
  for (int k = 0; k < 12; ++k) {
    const Imath::M44d placement = scaled(Imath::V3d(double{scale}) * Imath::V3d(stretch, 1, 1)) *
                                  turned(Imath::V3d(random_direction(generator)), 2) *
                                  moved(Imath::V3d(random_direction(generator) * (place * scale)));
    const Scene scene = instance_of(box, placement);
    const Accel accel(scene);
    const Shapes shapes(scene);
    for (int r = 0; r < 500; ++r) {
      const Vec3 target = Vec3(Imath::V3d(random_direction(generator) * 0.8f) * placement);
      const Vec3 eye = target + random_direction(generator) * (3 * scale);
      Hit hit;
      const Vec3 direction = (target - eye).normalized();
      if (!accel.intersect(eye, direction, hit)) continue;
      ++met;
      const Surface s = shapes.surface(hit, direction);
      Vec3 away = random_direction(generator);
      // Every other ray nearly along the surface.
      if (r % 2 == 0)
        away = (away - s.geometric_normal * (0.999f * dot(away, s.geometric_normal))).normalized();
      const float rise = dot(away, s.geometric_normal);
      if (std::abs(rise) < 1e-5f) continue;
      const bool found = accel.occluded(s.origin_toward(away), away, 1e30f);
      const bool outward = (rise > 0) == s.front;
      if (outward && found) ++again;
      // Not where a box has an edge just there.
      if (!outward && !found && std::abs(rise) > 0.05f) ++lost;
    }
  }
  CHECK(met > 3000);
  CHECK(again == 0);
  CHECK(lost == 0);
}

TEST_CASE("Copies are instances where as one mesh they would be many triangles", "[load][json]") {
  const TempFolder folder;
  const auto load = [&](const std::string& shape) {
    return load_scene(folder.write("s.json", with_shapes(shape)));
  };
  const std::string many = R"([{"count": 30, "step": {"translate": [3, 0, 0]}},
                               {"count": 10, "step": {"translate": [0, 0, 3]}}])";
  const Scene scene = load(lathes(64, "white", many));
  REQUIRE(scene.instances.size() == 300);
  CHECK(scene.meshes.empty());
  REQUIRE(scene.prototypes.size() == 1);
  CHECK(scene.prototypes[0].triangles.size() == 256);
  // Where the merged copies would be.
  Imath::Box3f box;
  for (const Instance& instance : scene.instances) {
    for (const Vec3& p : scene.prototypes[0].positions) box.extendBy(p * instance.placement);
  }
  check_point(box.min, {-1, 0, -1});
  check_point(box.max, {88, 1.2f, 28});
  check_point(scene.cameras.at(0).target, {43.5f, 0.6f, 13.5f});

  CHECK(load(lathes(64, "lamp", many)).meshes.size() == 1);   // a light
  CHECK(load(lathes(3, "white", many)).meshes.size() == 1);   // of few triangles
  CHECK(load(lathes(32, "white", many)).meshes.size() == 1);  // 38,400 in all
  CHECK(load(lathes(32, "white", many)).instances.empty());

  // As one mesh these would be more triangles than a scene may have.
  const std::string grid = R"([{"count": 100, "step": {"translate": [3, 0, 0]}},
                               {"count": 100, "step": {"translate": [0, 0, 3]}}])";
  CHECK(load(lathes(4096, "white", grid)).instances.size() == 10000);
}

TEST_CASE("Instances far from the origin lie around the scene's own", "[load][json]") {
  const TempFolder folder;
  const std::string repeat = R"({"count": 300, "step": {"translate": [3, 0, 0]}})";
  const std::string far = R"({"shape": "group", "transform": {"translate": [3e7, 0, 0]},
                              "shapes": [)" +
                          lathes(64, "white", repeat) + "]}";
  const Scene scene = load_scene(folder.write("s.json", with_shapes(far)));
  REQUIRE(scene.instances.size() == 300);
  const auto place = [&](std::size_t k) {
    return scene.space.world(Vec3(0, 0, 0) * scene.instances[k].placement);
  };
  CHECK(place(0).x == Approx(3e7).epsilon(1e-12));
  CHECK(place(299).x - place(0).x == Approx(897).epsilon(1e-6));
}

TEST_CASE("Instances and what they show are part of the hash", "[load][hash]") {
  const Scene base = instance_of(body(true), moved({1, 2, 3}));
  Scene placed = base, shown = base, more = base;
  placed.instances[0].placement[3][0] = 2;
  shown.prototypes[0].positions[3].x += 0.1f;
  more.instances.push_back(base.instances[0]);
  CHECK(hash_of(placed) != hash_of(base));
  CHECK(hash_of(shown) != hash_of(base));
  CHECK(hash_of(more) != hash_of(base));
}
