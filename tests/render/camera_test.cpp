// Camera rays against the matrices that the file gives for them.
#include "render/camera/camera.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "catch.h"
#include "core/error.h"

using namespace psf;
using namespace psf::render;

namespace {

Camera oblique() {
  Camera camera;
  camera.name = "oblique";
  camera.eye = Vec3(3, 2, -5);
  camera.target = Vec3(-1, 0.5f, 4);
  camera.up = Vec3(0.2f, 1, 0.1f);
  camera.fov = 0.9f;
  camera.width = 640;
  camera.height = 360;
  return camera;
}

// Where the matrices put a world position, in pixels.
std::pair<double, double> project(const formats::CameraInfo& info, const Vec3& position) {
  const auto& m = info.camera_to_world;
  double local[4] = {0, 0, 0, 1};
  for (std::size_t k = 0; k < 3; ++k) {  // the inverse of a rotation and a translation
    for (std::size_t r = 0; r < 3; ++r) {
      local[k] += m[4 * r + k] * (double{position[static_cast<int>(r)]} - m[4 * r + 3]);
    }
  }
  double clip[4] = {};
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t k = 0; k < 4; ++k) clip[r] += info.projection[4 * r + k] * local[k];
  }
  return {(clip[0] / clip[3] + 1) / 2 * info.width, (1 - clip[1] / clip[3]) / 2 * info.height};
}

}  // namespace

TEST_CASE("the matrices map a ray's hit back to the pixel that it came from") {
  const Camera camera = oblique();
  const CameraRays rays(camera);
  const auto info = rays.info();
  for (const Vec2& pixel :
       {Vec2(0, 0), Vec2(640, 360), Vec2(0.5f, 359.5f), Vec2(333.25f, 17.75f)}) {
    for (const float t : {0.1f, 3.0f, 1000.0f}) {
      const Ray ray = rays.ray(pixel, {0.5f, 0.5f});
      CHECK(std::abs(ray.direction.length() - 1) < 1e-6f);
      const auto [x, y] = project(info, ray.origin + ray.direction * t);
      CHECK(x == Approx(double{pixel.x}).margin(2e-3));
      CHECK(y == Approx(double{pixel.y}).margin(2e-3));
    }
  }
}

TEST_CASE("the picture is upright: x to the right, row 0 at the top") {
  Camera camera;  // at the origin, along -z
  camera.width = 200;
  camera.height = 100;
  const CameraRays rays(camera);
  const auto direction = [&](float x, float y) { return rays.ray({x, y}, {}).direction; };
  CHECK((direction(100, 50) - Vec3(0, 0, -1)).length() < 1e-6f);
  CHECK(direction(199, 50).x > 0.1f);
  CHECK(direction(1, 50).x < -0.1f);
  CHECK(direction(100, 1).y > 0.1f);
  CHECK(direction(100, 99).y < -0.1f);
  // Horizontal field of view: from the left edge to the right one.
  const float angle = std::acos(dot(direction(0, 50), direction(200, 50)));
  CHECK(angle == Approx(camera.fov).epsilon(1e-4));
  // Square pixels.
  CHECK(direction(150, 50).x / direction(150, 50).z ==
        Approx(direction(100, 0).y / direction(100, 0).z));
}

TEST_CASE("the angle per pixel is that between neighbours at the centre") {
  const CameraRays rays(oblique());
  const Vec3 a = rays.ray({319.5f, 180}, {}).direction;
  const Vec3 b = rays.ray({320.5f, 180}, {}).direction;
  CHECK(rays.info().angle_per_pixel == Approx(std::asin(cross(a, b).length())).epsilon(1e-3));
}

TEST_CASE("a lens moves the origin by at most its radius and keeps the plane of focus sharp") {
  Camera camera = oblique();
  camera.lens_radius = 0.3f;
  camera.focus_distance = 7;
  const CameraRays rays(camera);
  const Vec3 axis = (camera.target - camera.eye).normalized();
  for (const Vec2& pixel : {Vec2(10, 20), Vec2(600, 300)}) {
    Vec3 focus(0);
    for (const Vec2& lens : {Vec2(0.5f, 0.5f), Vec2(0, 0), Vec2(0.9f, 0.3f), Vec2(0.2f, 0.99f)}) {
      const Ray ray = rays.ray(pixel, lens);
      CHECK((ray.origin - camera.eye).length() <= 0.3001f);
      CHECK(std::abs(dot(ray.origin - camera.eye, axis)) < 1e-5f);
      const float t = (7 - dot(ray.origin - camera.eye, axis)) / dot(ray.direction, axis);
      const Vec3 hit = ray.origin + ray.direction * t;
      if (lens == Vec2(0.5f, 0.5f)) focus = hit;
      CHECK((hit - focus).length() < 1e-4f);
    }
  }
}

TEST_CASE("the map to the disk keeps areas") {
  // The share of a fine grid that lands within radius r is r^2, and each quadrant gets a quarter.
  constexpr int kSize = 400;
  int inside = 0;
  int quadrant = 0;
  float farthest = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Vec2 p = concentric_disk(
          {(static_cast<float>(x) + 0.5f) / kSize, (static_cast<float>(y) + 0.5f) / kSize});
      farthest = std::max(farthest, p.length());
      if (p.length() < 0.6f) ++inside;
      if (p.x > 0 && p.y > 0) ++quadrant;
    }
  }
  CHECK(farthest <= 1.000001f);
  CHECK(inside / double{kSize * kSize} == Approx(0.36).margin(0.002));
  CHECK(quadrant == kSize * kSize / 4);
  CHECK(concentric_disk({0.5f, 0.5f}) == Vec2(0, 0));
}

TEST_CASE("a camera without a view is refused by name") {
  const auto refused = [](const auto& change) {
    Camera camera = oblique();
    change(camera);
    try {
      CameraRays rays(camera);
    } catch (const Error& error) {
      return error.code() == ErrorCode::bad_input &&
             std::string(error.what()).find("\"oblique\"") != std::string::npos;
    }
    return false;
  };
  CHECK(refused([](Camera& c) { c.target = c.eye; }));
  CHECK(refused([](Camera& c) { c.up = c.target - c.eye; }));
  CHECK(refused([](Camera& c) { c.up = Vec3(0, 0, 0); }));
  CHECK(refused([](Camera& c) { c.eye.x = std::nanf(""); }));
  CHECK(refused([](Camera& c) { c.fov = 0; }));
  CHECK(refused([](Camera& c) { c.fov = std::numbers::pi_v<float>; }));
  CHECK(refused([](Camera& c) { c.width = 0; }));
  CHECK(refused([](Camera& c) { c.height = 70000; }));
  CHECK(refused([](Camera& c) { c.lens_radius = -1; }));
  CHECK_FALSE(refused([](Camera&) {}));
}
